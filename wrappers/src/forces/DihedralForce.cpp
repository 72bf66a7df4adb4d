#include "openmm-helfrich/DihedralForce.h"

using namespace HelfrichPlugin;

DihedralForce::DihedralForce(const std::vector<int>& triangles, double stiffness, Form form)
    : MembraneForce("DihedralForce", triangles, {stiffness}, form) {
}

double DihedralForce::getStiffness() const {
    return getParameterValue("stiffness");
}

void DihedralForce::setStiffness(double stiffness) {
    setParameterValue("stiffness", stiffness);
}

DihedralForce::Form DihedralForce::getForm() const {
    return (Form) MembraneForce::getForm();
}

void DihedralForce::setForm(Form form) {
    MembraneForce::setForm(form);
}
