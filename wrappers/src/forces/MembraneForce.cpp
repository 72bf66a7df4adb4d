#include "openmm-helfrich/MembraneForce.h"

#include "../Core.h"
#include "../UpdatableImpl.h"

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::string;
using std::vector;

MembraneForce::MembraneForce(const string& type, const vector<int>& triangles, const vector<double>& values,
                             int form)
    : type(type), form(0), switches(0) {
    setName(type);
    for (double value : values) {
        int index = (int) parameters.size();
        HelfrichParameterInfo info;
        check(Helfrich_Potential_parameter(type.c_str(), index, &info));
        check(Helfrich_Potential_check(type.c_str(), index, value));
        parameters.push_back({info.name, value, "", {}, info.per != 0});
    }
    if (form != 0)
        setForm(form);
    addTriangles(triangles);
}

void MembraneForce::fail(const string& message) const {
    throw OpenMMException(type + ": " + message);
}

int MembraneForce::addTriangle(int particle1, int particle2, int particle3) {
    triangles.insert(triangles.end(), {particle1, particle2, particle3});
    return getNumTriangles() - 1;
}

void MembraneForce::addTriangles(const vector<int>& corners) {
    if (corners.size() % 3 != 0)
        fail("a list of " + std::to_string(corners.size()) + " corners is not made of triangles");
    triangles.insert(triangles.end(), corners.begin(), corners.end());
}

void MembraneForce::getTriangle(int index, int& particle1, int& particle2, int& particle3) const {
    if (index < 0 || index >= getNumTriangles())
        fail("there is no triangle " + std::to_string(index) + " among " + std::to_string(getNumTriangles()));
    particle1 = triangles[3 * index];
    particle2 = triangles[3 * index + 1];
    particle3 = triangles[3 * index + 2];
}

const string& MembraneForce::getParameterName(int index) const {
    if (index < 0 || index >= getNumParameters())
        fail("there is no parameter " + std::to_string(index) + " among " + std::to_string(getNumParameters()));
    return parameters[index].name;
}

int MembraneForce::findParameter(const string& name) const {
    string known;
    for (int i = 0; i < getNumParameters(); i++) {
        if (parameters[i].name == name)
            return i;
        known += (i == 0 ? "" : ", ") + parameters[i].name;
    }
    fail("there is no parameter called \"" + name + "\"; known are: " + known);
}

double MembraneForce::getParameterValue(const string& name) const {
    return parameters[findParameter(name)].value;
}

void MembraneForce::setParameterValue(const string& name, double value) {
    int index = findParameter(name);
    check(Helfrich_Potential_check(type.c_str(), index, value));
    parameters[index].value = value;
}

void MembraneForce::setElementValues(const string& name, const vector<double>& values) {
    int index = findParameter(name);
    if (!parameters[index].perElement && !values.empty())
        fail(name + " is one value for the whole membrane; it cannot be given for single elements");
    for (size_t i = 0; i < values.size(); i++)
        if (Helfrich_Potential_check(type.c_str(), index, values[i]) != 0)
            throw OpenMMException(lastError() + " at index " + std::to_string(i));
    parameters[index].elementValues = values;
}

const vector<double>& MembraneForce::getElementValues(const string& name) const {
    return parameters[findParameter(name)].elementValues;
}

void MembraneForce::setContextParameter(const string& parameter, const string& name) {
    parameters[findParameter(parameter)].contextParameter = name;
}

const string& MembraneForce::getContextParameter(const string& parameter) const {
    return parameters[findParameter(parameter)].contextParameter;
}

void MembraneForce::addEnergyParameterDerivative(const string& name) {
    for (const Parameter& parameter : parameters)
        if (!name.empty() && parameter.contextParameter == name) {
            derivatives.push_back(name);
            return;
        }
    fail("no scalar has the Context parameter \"" + name + "\"; call setContextParameter() first");
}

const string& MembraneForce::getEnergyParameterDerivativeName(int index) const {
    if (index < 0 || index >= getNumEnergyParameterDerivatives())
        fail("there is no derivative " + std::to_string(index));
    return derivatives[index];
}

void MembraneForce::setForm(int number) {
    const char *what, *name;
    check(Helfrich_Potential_form(type.c_str(), number, &what, &name));
    form = number;
}

unsigned int MembraneForce::findSwitch(const string& name) const {
    const char* found;
    for (int i = 0; Helfrich_Potential_switch(type.c_str(), i, &found) == 0; i++)
        if (name == found)
            return 1u << i;
    fail("there is no switch called \"" + name + "\"");
}

bool MembraneForce::getSwitch(const string& name) const {
    return (switches & findSwitch(name)) != 0;
}

void MembraneForce::setSwitch(const string& name, bool on) {
    unsigned int bit = findSwitch(name);
    switches = on ? switches | bit : switches & ~bit;
}

void MembraneForce::updateParametersInContext(Context& context) {
    dynamic_cast<UpdatableImpl&>(getImplInContext(context)).updateParametersInContext(getContextImpl(context));
}

ForceImpl* MembraneForce::createImpl() const {
    return static_cast<ForceImpl*>(Helfrich_createImpl(this));
}
