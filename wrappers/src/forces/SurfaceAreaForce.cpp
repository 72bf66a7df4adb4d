#include "openmm-helfrich/SurfaceAreaForce.h"

using namespace HelfrichPlugin;

SurfaceAreaForce::SurfaceAreaForce(const std::vector<int>& triangles, double modulus, double target)
    : MembraneForce("SurfaceAreaForce", triangles, {modulus, target}) {
}

double SurfaceAreaForce::getModulus() const {
    return getParameterValue("modulus");
}

void SurfaceAreaForce::setModulus(double modulus) {
    setParameterValue("modulus", modulus);
}

double SurfaceAreaForce::getTarget() const {
    return getParameterValue("target");
}

void SurfaceAreaForce::setTarget(double target) {
    setParameterValue("target", target);
}
