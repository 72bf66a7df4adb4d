#include "MembraneForceProxy.h"

#include "OpenMMHelfrich.h"
#include "XmlElements.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <set>
#include <vector>

using namespace HelfrichPlugin;
using namespace HelfrichPlugin::xml;
using namespace OpenMM;
using std::set;
using std::string;
using std::vector;

namespace {

/** Forces in a periodic box have a version of their own, since earlier releases would compute something else. */
const int VERSION = 1, PERIODIC_VERSION = 2;

/** Find the forms of a potential: what they are called, and the name of one. False if there is none. */
bool findForm(const string& force, int index, string& what, string& name) {
    const char *whatText, *nameText;
    if (Helfrich_Potential_form(force.c_str(), index, &whatText, &nameText) != Helfrich_Success)
        return false;
    what = whatText;
    name = nameText;
    return true;
}

/** What a class calls the numbers that it has for each vertex, as an element: "Reference"; empty if it has none. */
string findNumbers(const string& force) {
    const char* name;
    if (Helfrich_Potential_numbers(force.c_str(), &name) == 0)
        return "";
    string element = name;
    element[0] = (char) std::toupper(element[0]);
    return element;
}

/** The attributes of a vertex there. */
const vector<string> coordinates = {"x", "y", "z"}, label = {"number"};

void writeRows(SerializationNode& node, const string& name, const vector<string>& attributes,
               const vector<double>& numbers) {
    for (size_t i = 0; i + attributes.size() <= numbers.size(); i += attributes.size()) {
        SerializationNode& row = node.createChildNode(name);
        for (size_t k = 0; k < attributes.size(); k++)
            row.setDoubleProperty(attributes[k], numbers[i + k]);
    }
}

vector<double> readRows(const string& force, const SerializationNode& node, const string& name,
                        const vector<string>& attributes) {
    vector<double> numbers;
    for (const SerializationNode& row : node.getChildren()) {
        if (row.getName() != name)
            continue;
        allow(force, row, set<string>(attributes.begin(), attributes.end()), {});
        for (const string& attribute : attributes)
            numbers.push_back(number(force, row, attribute));
    }
    return numbers;
}

/** The names of a potential's switches. */
vector<string> findSwitches(const string& force) {
    vector<string> names;
    const char* name;
    while (Helfrich_Potential_switch(force.c_str(), (int) names.size(), &name) == Helfrich_Success)
        names.push_back(name);
    return names;
}

} // namespace

MembraneForceProxy::MembraneForceProxy(const string& forceName, Factory create)
    : SerializationProxy("Helfrich" + forceName), forceName(forceName), create(create) {
}

void MembraneForceProxy::serialize(const void* object, SerializationNode& node) const {
    const MembraneForce& force = *static_cast<const MembraneForce*>(object);
    bool isPeriodic = force.usesPeriodicBoundaryConditions();
    node.setIntProperty("version", isPeriodic ? PERIODIC_VERSION : VERSION);
    node.setIntProperty("forceGroup", force.getForceGroup());
    node.setStringProperty("name", force.getName());
    string what, name;
    if (findForm(forceName, force.getForm(), what, name))
        node.setStringProperty(what, name);
    for (const string& name : findSwitches(forceName))
        node.setBoolProperty(name, force.getSwitch(name));
    if (!force.getBackend().empty())
        node.setStringProperty("backend", force.getBackend());
    if (isPeriodic)
        node.setBoolProperty("usesPeriodic", true);
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
    writeTriangles(force, node);
    string numbers = findNumbers(forceName);
    if (!numbers.empty()) {
        bool isReference = numbers == "Reference";
        SerializationNode& vertices = node.createChildNode(numbers);
        writeRows(vertices, "Vertex", isReference ? coordinates : label, force.getVertexNumbers());
        writeRows(vertices, "BoxVector", coordinates, force.getReferenceBox());
    }
    if (!force.getParticles().empty()) {
        SerializationNode& particles = node.createChildNode("Particles");
        for (int particle : force.getParticles())
            particles.createChildNode("Particle").setIntProperty("index", particle);
    }
}

void* MembraneForceProxy::deserialize(const SerializationNode& node) const {
    std::unique_ptr<MembraneForce> force(create());
    within(forceName, node, [&] { readForce(node, *force); });
    return static_cast<Force*>(force.release());
}

void MembraneForceProxy::readForce(const SerializationNode& node, MembraneForce& force) const {
    int version = integer(forceName, node, "version");
    if (version < VERSION || version > PERIODIC_VERSION)
        throw OpenMMException(about(forceName, node) + "has version " + std::to_string(version) + ", but only " +
                              std::to_string(VERSION) + " to " + std::to_string(PERIODIC_VERSION) +
                              " are known; it was written by another release of openmm-helfrich");
    string what, name;
    bool hasForms = findForm(forceName, 0, what, name);
    vector<string> switches = findSwitches(forceName);
    set<string> attributes = {"type", "version", "forceGroup", "name", "backend", "usesPeriodic"};
    attributes.insert(switches.begin(), switches.end());
    if (hasForms)
        attributes.insert(what);
    set<string> children = {"Parameters", "EnergyParameterDerivatives", "Triangles", "Particles"};
    string numbers = findNumbers(forceName);
    if (!numbers.empty())
        children.insert(numbers);
    allow(forceName, node, attributes, children);
    // What has a default may be left out, as in OpenMM's own XML.
    if (node.hasProperty("forceGroup"))
        force.setForceGroup(integer(forceName, node, "forceGroup"));
    if (node.hasProperty("name"))
        force.setName(text(forceName, node, "name"));
    if (node.hasProperty("backend"))
        force.setBackend(text(forceName, node, "backend"));
    if (node.hasProperty("usesPeriodic"))
        force.setUsesPeriodicBoundaryConditions(boolean(forceName, node, "usesPeriodic"));
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
    readTriangles(forceName, node, force);
    readOtherParticles(node, force);
    if (numbers.empty())
        return;
    const SerializationNode& vertices = child(forceName, node, numbers);
    bool isReference = numbers == "Reference";
    allow(forceName, vertices, {}, isReference ? set<string>{"Vertex", "BoxVector"} : set<string>{"Vertex"});
    within(forceName, vertices, [&] {
        force.setVertexNumbers(readRows(forceName, vertices, "Vertex", isReference ? coordinates : label));
        vector<double> box = readRows(forceName, vertices, "BoxVector", coordinates);
        if (!box.empty())
            force.setReferenceBox(box);
    });
}

void MembraneForceProxy::readOtherParticles(const SerializationNode& node, MembraneForce& force) const {
    const vector<SerializationNode>& children = node.getChildren();
    if (std::none_of(children.begin(), children.end(),
                     [](const SerializationNode& element) { return element.getName() == "Particles"; }))
        return;
    auto* owner = dynamic_cast<ParticleSurfaceForce*>(&force);
    if (owner == nullptr)
        throw OpenMMException(about(forceName, node) + "has an unknown child <Particles>");
    const SerializationNode& particles = child(forceName, node, "Particles");
    allow(forceName, particles, {}, {"Particle"});
    vector<int> indices;
    for (const SerializationNode& element : particles.getChildren()) {
        allow(forceName, element, {"index"}, {});
        indices.push_back(integer(forceName, element, "index"));
    }
    owner->setParticles(indices);
}

void MembraneForceProxy::readParameters(const SerializationNode& parameters, MembraneForce& force) const {
    allow(forceName, parameters, {}, {"Parameter"});
    set<string> missing;
    for (int i = 0; i < force.getNumParameters(); i++) {
        // What has a default may have come later than the file.
        HelfrichParameterInfo info;
        check(Helfrich_Potential_parameter(forceName.c_str(), i, &info));
        if (std::isnan(info.defaultValue))
            missing.insert(info.name);
        else
            force.setParameterValue(info.name, info.defaultValue);
    }
    set<string> met;
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
        missing.erase(parameter);
        if (!met.insert(parameter).second)
            throw OpenMMException(about(forceName, parameters) + "has \"" + parameter + "\" twice");
    }
    if (!missing.empty())
        throw OpenMMException(about(forceName, parameters) + "lacks \"" + *missing.begin() + "\"");
}
