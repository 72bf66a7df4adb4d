#include "openmm-helfrich/PlaquetteAreaForce.h"

using namespace HelfrichPlugin;

PlaquetteAreaForce::PlaquetteAreaForce(const std::vector<int>& triangles, double stiffness, double target)
    : MembraneForce("PlaquetteAreaForce", triangles, {stiffness, target}) {
}

double PlaquetteAreaForce::getStiffness() const {
    return getParameterValue("stiffness");
}

void PlaquetteAreaForce::setStiffness(double stiffness) {
    setParameterValue("stiffness", stiffness);
}

double PlaquetteAreaForce::getTarget() const {
    return getParameterValue("target");
}

void PlaquetteAreaForce::setTarget(double target) {
    setParameterValue("target", target);
}
