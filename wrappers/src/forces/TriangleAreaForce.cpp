#include "openmm-helfrich/TriangleAreaForce.h"

using namespace HelfrichPlugin;

TriangleAreaForce::TriangleAreaForce(const std::vector<int>& triangles, double modulus, double target)
    : MembraneForce("TriangleAreaForce", triangles, {modulus, target}) {
}

double TriangleAreaForce::getModulus() const {
    return getParameterValue("modulus");
}

void TriangleAreaForce::setModulus(double modulus) {
    setParameterValue("modulus", modulus);
}

double TriangleAreaForce::getTarget() const {
    return getParameterValue("target");
}

void TriangleAreaForce::setTarget(double target) {
    setParameterValue("target", target);
}

const std::vector<double>& TriangleAreaForce::getTriangleTargets() const {
    return getElementValues("target");
}

void TriangleAreaForce::setTriangleTargets(const std::vector<double>& values) {
    setElementValues("target", values);
}
