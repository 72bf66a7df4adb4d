#include "MembraneForceProxy.h"

#include "openmm-helfrich/internal/Core.h"

#include <openmm/serialization/SerializationNode.h>

#include <memory>
#include <set>
#include <vector>

using namespace HelfrichPlugin;
using namespace OpenMM;
using std::set;
using std::string;
using std::vector;

namespace {

const int VERSION = 1;

/** Find the variants of a potential: what they are called, and the name of one. False if there is none. */
bool findForm(const string& force, int index, string& what, string& name) {
    const char *whatText, *nameText;
    if (Helfrich_Potential_form(force.c_str(), index, &whatText, &nameText) != 0)
        return false;
    what = whatText;
    name = nameText;
    return true;
}

/** The names of a potential's switches. */
vector<string> findSwitches(const string& force) {
    vector<string> names;
    const char* name;
    while (Helfrich_Potential_switch(force.c_str(), (int) names.size(), &name) == 0)
        names.push_back(name);
    return names;
}

/** Refuse what a node should not have, so that nothing is lost unnoticed. */
void allow(const string& force, const SerializationNode& node, const set<string>& properties,
           const set<string>& children) {
    string where = force + ": element <" + node.getName() + "> ";
    for (const auto& property : node.getProperties())
        if (properties.count(property.first) == 0)
            throw OpenMMException(where + "has an unknown attribute \"" + property.first + "\"");
    for (const SerializationNode& child : node.getChildren()) {
        if (children.count(child.getName()) == 0)
            throw OpenMMException(where + "has an unknown child <" + child.getName() + ">");
    }
}

/** Require an attribute. */
void require(const string& force, const SerializationNode& node, const string& property) {
    if (!node.hasProperty(property))
        throw OpenMMException(force + ": element <" + node.getName() + "> lacks the attribute \"" + property + "\"");
}

/** Require a child. */
const SerializationNode& child(const string& force, const SerializationNode& node, const string& name) {
    for (const SerializationNode& candidate : node.getChildren())
        if (candidate.getName() == name)
            return candidate;
    throw OpenMMException(force + ": element <" + node.getName() + "> lacks the child <" + name + ">");
}

} // namespace

MembraneForceProxy::MembraneForceProxy(const string& forceName, Factory create)
    : SerializationProxy("Helfrich" + forceName), forceName(forceName), create(create) {
}

void MembraneForceProxy::serialize(const void* object, SerializationNode& node) const {
    const MembraneForce& force = *static_cast<const MembraneForce*>(object);
    node.setIntProperty("version", VERSION);
    node.setIntProperty("forceGroup", force.getForceGroup());
    node.setStringProperty("name", force.getName());
    string what, name;
    if (findForm(forceName, force.getForm(), what, name))
        node.setStringProperty(what, name);
    for (const string& name : findSwitches(forceName))
        node.setBoolProperty(name, force.getSwitch(name));
    SerializationNode& parameters = node.createChildNode("Parameters");
    for (int i = 0; i < force.getNumParameters(); i++) {
        const string& parameter = force.getParameterName(i);
        SerializationNode& element = parameters.createChildNode("Parameter");
        element.setStringProperty("name", parameter).setDoubleProperty("value", force.getParameterValue(parameter));
        if (!force.getContextParameter(parameter).empty())
            element.setStringProperty("contextParameter", force.getContextParameter(parameter));
        for (double value : force.getElementValues(parameter))
            element.createChildNode("Element").setDoubleProperty("value", value);
    }
    SerializationNode& derivatives = node.createChildNode("EnergyParameterDerivatives");
    for (int i = 0; i < force.getNumEnergyParameterDerivatives(); i++)
        derivatives.createChildNode("Derivative")
            .setStringProperty("contextParameter", force.getEnergyParameterDerivativeName(i));
    SerializationNode& triangles = node.createChildNode("Triangles");
    for (int i = 0; i < force.getNumTriangles(); i++) {
        int p1, p2, p3;
        force.getTriangle(i, p1, p2, p3);
        triangles.createChildNode("Triangle")
            .setIntProperty("p1", p1)
            .setIntProperty("p2", p2)
            .setIntProperty("p3", p3);
    }
}

void* MembraneForceProxy::deserialize(const SerializationNode& node) const {
    require(forceName, node, "version");
    int version = node.getIntProperty("version");
    if (version != VERSION)
        throw OpenMMException(forceName + ": element <" + node.getName() + "> has version " + std::to_string(version) +
                              ", but only " + std::to_string(VERSION) +
                              " is known; it was written by another release of openmm-helfrich");
    std::unique_ptr<MembraneForce> force(create());
    string what, name;
    bool hasForms = findForm(forceName, 0, what, name);
    set<string> attributes = {"type", "version", "forceGroup", "name"};
    if (hasForms)
        attributes.insert(what);
    vector<string> switches = findSwitches(forceName);
    attributes.insert(switches.begin(), switches.end());
    allow(forceName, node, attributes, {"Parameters", "EnergyParameterDerivatives", "Triangles"});
    force->setForceGroup(node.getIntProperty("forceGroup", 0));
    force->setName(node.getStringProperty("name", force->getName()));
    if (hasForms) {
        require(forceName, node, what);
        string wanted = node.getStringProperty(what);
        int form = 0;
        while (findForm(forceName, form, what, name) && name != wanted)
            form++;
        if (name != wanted)
            throw OpenMMException(forceName + ": element <" + node.getName() + "> has the unknown " + what + " \"" +
                                  wanted + "\"");
        force->setForm(form);
    }
    for (const string& name : switches)
        force->setSwitch(name, node.getBoolProperty(name, false));

    const SerializationNode& parameters = child(forceName, node, "Parameters");
    allow(forceName, parameters, {}, {"Parameter"});
    set<string> missing;
    for (int i = 0; i < force->getNumParameters(); i++)
        missing.insert(force->getParameterName(i));
    for (const SerializationNode& element : parameters.getChildren()) {
        allow(forceName, element, {"name", "value", "contextParameter"}, {"Element"});
        require(forceName, element, "name");
        require(forceName, element, "value");
        string parameter = element.getStringProperty("name");
        force->setParameterValue(parameter, element.getDoubleProperty("value"));
        force->setContextParameter(parameter, element.getStringProperty("contextParameter", ""));
        vector<double> values;
        for (const SerializationNode& child : element.getChildren()) {
            allow(forceName, child, {"value"}, {});
            require(forceName, child, "value");
            values.push_back(child.getDoubleProperty("value"));
        }
        force->setElementValues(parameter, values);
        if (missing.erase(parameter) == 0)
            throw OpenMMException(forceName + ": element <Parameters> has \"" + parameter + "\" twice");
    }
    if (!missing.empty())
        throw OpenMMException(forceName + ": element <Parameters> lacks \"" + *missing.begin() + "\"");

    const SerializationNode& derivatives = child(forceName, node, "EnergyParameterDerivatives");
    allow(forceName, derivatives, {}, {"Derivative"});
    for (const SerializationNode& element : derivatives.getChildren()) {
        allow(forceName, element, {"contextParameter"}, {});
        require(forceName, element, "contextParameter");
        force->addEnergyParameterDerivative(element.getStringProperty("contextParameter"));
    }

    const SerializationNode& triangles = child(forceName, node, "Triangles");
    allow(forceName, triangles, {}, {"Triangle"});
    for (const SerializationNode& element : triangles.getChildren()) {
        allow(forceName, element, {"p1", "p2", "p3"}, {});
        for (const char* corner : {"p1", "p2", "p3"})
            require(forceName, element, corner);
        force->addTriangle(element.getIntProperty("p1"), element.getIntProperty("p2"), element.getIntProperty("p3"));
    }
    return static_cast<Force*>(force.release());
}
