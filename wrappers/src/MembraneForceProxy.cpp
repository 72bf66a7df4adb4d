#include "MembraneForceProxy.h"

#include "openmm-helfrich/internal/Core.h"

#include <openmm/serialization/SerializationNode.h>

#include <cerrno>
#include <climits>
#include <cstdlib>
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

/** The beginning of a message about an element. */
string about(const string& force, const SerializationNode& node) {
    // The element of the force itself has no name when it is the root.
    return force + ": element <" + (node.getName().empty() ? "Force" : node.getName()) + "> ";
}

/** Refuse what a node should not have, so that nothing is lost unnoticed. */
void allow(const string& force, const SerializationNode& node, const set<string>& properties,
           const set<string>& children) {
    string where = about(force, node);
    for (const auto& property : node.getProperties())
        if (properties.count(property.first) == 0)
            throw OpenMMException(where + "has an unknown attribute \"" + property.first + "\"");
    for (const SerializationNode& child : node.getChildren()) {
        if (children.count(child.getName()) == 0)
            throw OpenMMException(where + "has an unknown child <" + child.getName() + ">");
    }
}

/** The text of an attribute that must be there. */
string text(const string& force, const SerializationNode& node, const string& property) {
    if (!node.hasProperty(property))
        throw OpenMMException(about(force, node) + "lacks the attribute \"" + property + "\"");
    return node.getStringProperty(property);
}

[[noreturn]] void refuse(const string& force, const SerializationNode& node, const string& property,
                         const string& expected) {
    throw OpenMMException(about(force, node) + "has " + property + "=\"" + node.getStringProperty(property) +
                          "\", which is not " + expected);
}

/** A number to the last character: what is broken shall not become a zero. */
double number(const string& force, const SerializationNode& node, const string& property) {
    string value = text(force, node, property);
    char* end = nullptr;
    double result = std::strtod(value.c_str(), &end);
    if (value.empty() || *end != '\0')
        refuse(force, node, property, "a number");
    return result;
}

int integer(const string& force, const SerializationNode& node, const string& property) {
    string value = text(force, node, property);
    char* end = nullptr;
    errno = 0;
    long result = std::strtol(value.c_str(), &end, 10);
    if (value.empty() || *end != '\0' || errno != 0 || result < INT_MIN || result > INT_MAX)
        refuse(force, node, property, "an integer");
    return (int) result;
}

bool boolean(const string& force, const SerializationNode& node, const string& property) {
    string value = text(force, node, property);
    if (value != "0" && value != "1" && value != "true" && value != "false")
        refuse(force, node, property, "true or false");
    return value == "1" || value == "true";
}

/** The one child of a name. */
const SerializationNode& child(const string& force, const SerializationNode& node, const string& name) {
    const SerializationNode* found = nullptr;
    for (const SerializationNode& candidate : node.getChildren())
        if (candidate.getName() == name) {
            if (found != nullptr)
                throw OpenMMException(about(force, node) + "has the child <" + name + "> twice");
            found = &candidate;
        }
    if (found == nullptr)
        throw OpenMMException(about(force, node) + "lacks the child <" + name + ">");
    return *found;
}

/** Do something with an element's content; what it throws shall name the element. */
template <class Body>
void within(const string& force, const SerializationNode& node, Body body) {
    try {
        body();
    } catch (const OpenMMException& error) {
        string message = error.what();
        if (message.find("element <") != string::npos)
            throw;
        throw OpenMMException(message + " (in element <" + (node.getName().empty() ? "Force" : node.getName()) + ">)");
    }
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
    if (!force.getBackend().empty())
        node.setStringProperty("backend", force.getBackend());
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
    std::unique_ptr<MembraneForce> force(create());
    within(forceName, node, [&] { readForce(node, *force); });
    return static_cast<Force*>(force.release());
}

void MembraneForceProxy::readForce(const SerializationNode& node, MembraneForce& force) const {
    int version = integer(forceName, node, "version");
    if (version != VERSION)
        throw OpenMMException(about(forceName, node) + "has version " + std::to_string(version) + ", but only " +
                              std::to_string(VERSION) +
                              " is known; it was written by another release of openmm-helfrich");
    string what, name;
    bool hasForms = findForm(forceName, 0, what, name);
    vector<string> switches = findSwitches(forceName);
    set<string> attributes = {"type", "version", "forceGroup", "name", "backend"};
    attributes.insert(switches.begin(), switches.end());
    if (hasForms)
        attributes.insert(what);
    allow(forceName, node, attributes, {"Parameters", "EnergyParameterDerivatives", "Triangles"});
    // What has a default may be left out, as in OpenMM's own XML.
    if (node.hasProperty("forceGroup"))
        force.setForceGroup(integer(forceName, node, "forceGroup"));
    if (node.hasProperty("name"))
        force.setName(text(forceName, node, "name"));
    if (node.hasProperty("backend"))
        force.setBackend(text(forceName, node, "backend"));
    if (hasForms) {
        string wanted = text(forceName, node, what);
        int form = 0;
        while (findForm(forceName, form, what, name) && name != wanted)
            form++;
        if (name != wanted)
            refuse(forceName, node, what, "known");
        force.setForm(form);
    }
    for (const string& property : switches)
        if (node.hasProperty(property))
            force.setSwitch(property, boolean(forceName, node, property));
    readParameters(child(forceName, node, "Parameters"), force);

    const SerializationNode& derivatives = child(forceName, node, "EnergyParameterDerivatives");
    allow(forceName, derivatives, {}, {"Derivative"});
    for (const SerializationNode& element : derivatives.getChildren()) {
        allow(forceName, element, {"contextParameter"}, {});
        string parameter = text(forceName, element, "contextParameter");
        within(forceName, element, [&] { force.addEnergyParameterDerivative(parameter); });
    }

    const SerializationNode& triangles = child(forceName, node, "Triangles");
    allow(forceName, triangles, {}, {"Triangle"});
    for (const SerializationNode& element : triangles.getChildren()) {
        allow(forceName, element, {"p1", "p2", "p3"}, {});
        force.addTriangle(integer(forceName, element, "p1"), integer(forceName, element, "p2"),
                          integer(forceName, element, "p3"));
    }
}

void MembraneForceProxy::readParameters(const SerializationNode& parameters, MembraneForce& force) const {
    allow(forceName, parameters, {}, {"Parameter"});
    set<string> missing;
    for (int i = 0; i < force.getNumParameters(); i++)
        missing.insert(force.getParameterName(i));
    for (const SerializationNode& element : parameters.getChildren()) {
        allow(forceName, element, {"name", "value", "contextParameter"}, {"Element"});
        string parameter = text(forceName, element, "name");
        double value = number(forceName, element, "value");
        vector<double> values;
        for (const SerializationNode& child : element.getChildren()) {
            allow(forceName, child, {"value"}, {});
            values.push_back(number(forceName, child, "value"));
        }
        within(forceName, element, [&] {
            force.setParameterValue(parameter, value);
            force.setContextParameter(parameter, element.getStringProperty("contextParameter", ""));
            force.setElementValues(parameter, values);
        });
        if (missing.erase(parameter) == 0)
            throw OpenMMException(about(forceName, parameters) + "has \"" + parameter + "\" twice");
    }
    if (!missing.empty())
        throw OpenMMException(about(forceName, parameters) + "lacks \"" + *missing.begin() + "\"");
}
