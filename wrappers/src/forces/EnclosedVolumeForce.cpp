#include "openmm-helfrich/EnclosedVolumeForce.h"

using namespace HelfrichPlugin;

EnclosedVolumeForce::EnclosedVolumeForce(const std::vector<int>& triangles, double modulus, double target)
    : MembraneForce("EnclosedVolumeForce", triangles, {modulus, target}) {
}

double EnclosedVolumeForce::getModulus() const {
    return getParameterValue("modulus");
}

void EnclosedVolumeForce::setModulus(double modulus) {
    setParameterValue("modulus", modulus);
}

double EnclosedVolumeForce::getTarget() const {
    return getParameterValue("target");
}

void EnclosedVolumeForce::setTarget(double target) {
    setParameterValue("target", target);
}
