#include "openmm-helfrich/TriangleHeightForce.h"

using namespace HelfrichPlugin;

TriangleHeightForce::TriangleHeightForce(const std::vector<int>& triangles, double minHeight, double epsilon)
    : MembraneForce("TriangleHeightForce", triangles, {minHeight, epsilon}) {
}

double TriangleHeightForce::getMinHeight() const {
    return getParameterValue("minHeight");
}

void TriangleHeightForce::setMinHeight(double minHeight) {
    setParameterValue("minHeight", minHeight);
}

double TriangleHeightForce::getEpsilon() const {
    return getParameterValue("epsilon");
}

void TriangleHeightForce::setEpsilon(double epsilon) {
    setParameterValue("epsilon", epsilon);
}
