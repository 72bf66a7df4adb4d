#include "openmm-helfrich/TriangleAreaRepulsionForce.h"

using namespace HelfrichPlugin;

TriangleAreaRepulsionForce::TriangleAreaRepulsionForce(const std::vector<int>& triangles, double minArea, double epsilon)
    : MembraneForce("TriangleAreaRepulsionForce", triangles, {minArea, epsilon}) {
}

double TriangleAreaRepulsionForce::getMinArea() const {
    return getParameterValue("minArea");
}

void TriangleAreaRepulsionForce::setMinArea(double minArea) {
    setParameterValue("minArea", minArea);
}

double TriangleAreaRepulsionForce::getEpsilon() const {
    return getParameterValue("epsilon");
}

void TriangleAreaRepulsionForce::setEpsilon(double epsilon) {
    setParameterValue("epsilon", epsilon);
}
