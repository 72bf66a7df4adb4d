#include "openmm-helfrich/BendingForce.h"

using namespace HelfrichPlugin;

BendingForce::BendingForce(const std::vector<int>& triangles, double rigidity, double spontaneousCurvature,
                           Scheme scheme)
    : MembraneForce("BendingForce", triangles, {rigidity, spontaneousCurvature}, scheme) {
}

double BendingForce::getRigidity() const {
    return getParameterValue("rigidity");
}

void BendingForce::setRigidity(double rigidity) {
    setParameterValue("rigidity", rigidity);
}

double BendingForce::getSpontaneousCurvature() const {
    return getParameterValue("spontaneousCurvature");
}

void BendingForce::setSpontaneousCurvature(double spontaneousCurvature) {
    setParameterValue("spontaneousCurvature", spontaneousCurvature);
}

BendingForce::Scheme BendingForce::getScheme() const {
    return (Scheme) getForm();
}

void BendingForce::setScheme(Scheme scheme) {
    setForm(scheme);
}

bool BendingForce::getUnsignedSpontaneousCurvature() const {
    return getSwitch("unsignedSpontaneousCurvature");
}

void BendingForce::setUnsignedSpontaneousCurvature(bool isUnsigned) {
    setSwitch("unsignedSpontaneousCurvature", isUnsigned);
}

const std::vector<double>& BendingForce::getVertexRigidity() const {
    return getElementValues("rigidity");
}

void BendingForce::setVertexRigidity(const std::vector<double>& values) {
    setElementValues("rigidity", values);
}

const std::vector<double>& BendingForce::getVertexSpontaneousCurvature() const {
    return getElementValues("spontaneousCurvature");
}

void BendingForce::setVertexSpontaneousCurvature(const std::vector<double>& values) {
    setElementValues("spontaneousCurvature", values);
}
