#ifndef HELFRICH_XML_ELEMENTS_H_
#define HELFRICH_XML_ELEMENTS_H_

#include "SystemCalls.h"
#include "openmm-helfrich/MonteCarloSurfaceMover.h"

#include <openmm/serialization/SerializationNode.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <iterator>
#include <set>
#include <string>

namespace HelfrichPlugin {

/** What the proxies read XML with; messages begin with the class of the force and name the element. */
namespace xml {

/** The name of an element, as XML has it. */
inline std::string elementName(const std::string& type, const OpenMM::SerializationNode& node) {
    if (!node.getName().empty())
        return node.getName();
    // The element of the object itself has no name when it is the root.
    const std::string integrator = "Integrator";
    bool isIntegrator = type.size() >= integrator.size() &&
        type.compare(type.size() - integrator.size(), integrator.size(), integrator) == 0;
    return isIntegrator ? integrator : "Force";
}

/** The beginning of a message about an element. */
inline std::string about(const std::string& force, const OpenMM::SerializationNode& node) {
    return force + ": element <" + elementName(force, node) + "> ";
}

/** Refuse what a node should not have, so that nothing is lost unnoticed. */
inline void allow(const std::string& force, const OpenMM::SerializationNode& node,
                  const std::set<std::string>& properties, const std::set<std::string>& children) {
    std::string where = about(force, node);
    for (const auto& property : node.getProperties())
        if (properties.count(property.first) == 0)
            throw OpenMM::OpenMMException(where + "has an unknown attribute \"" + property.first + "\"");
    for (const OpenMM::SerializationNode& child : node.getChildren()) {
        if (children.count(child.getName()) == 0)
            throw OpenMM::OpenMMException(where + "has an unknown child <" + child.getName() + ">");
    }
}

/** The text of an attribute that must be there. */
inline std::string text(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property) {
    if (!node.hasProperty(property))
        throw OpenMM::OpenMMException(about(force, node) + "lacks the attribute \"" + property + "\"");
    return node.getStringProperty(property);
}

[[noreturn]] inline void refuse(const std::string& force, const OpenMM::SerializationNode& node,
                                const std::string& property, const std::string& expected) {
    throw OpenMM::OpenMMException(about(force, node) + "has " + property + "=\"" + node.getStringProperty(property) +
                                  "\", which is not " + expected);
}

/** A number to the last character, with a point in any locale: what is broken shall not become a zero. */
inline double number(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property) {
    std::string value = text(force, node, property);
    char* end = nullptr;
    double result = plainNumber(value.c_str(), &end);
    // The C library would read hexadecimal numbers, which nobody writes.
    if (value.empty() || *end != '\0' || value.find_first_of("xX") != std::string::npos)
        refuse(force, node, property, "a number");
    return result;
}

inline int integer(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property) {
    std::string value = text(force, node, property);
    char* end = nullptr;
    errno = 0;
    long result = std::strtol(value.c_str(), &end, 10);
    if (value.empty() || *end != '\0' || errno != 0 || result < INT_MIN || result > INT_MAX)
        refuse(force, node, property, "an integer");
    return (int) result;
}

/** What has a default may be left out, as in OpenMM's own XML. */
inline double numberOr(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property,
                       double value) {
    return node.hasProperty(property) ? number(force, node, property) : value;
}

inline int integerOr(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property,
                     int value) {
    return node.hasProperty(property) ? integer(force, node, property) : value;
}

/** Refuse what another release has written. */
inline void checkVersion(const std::string& force, const OpenMM::SerializationNode& node, int known) {
    int version = integer(force, node, "version");
    if (version != known)
        throw OpenMM::OpenMMException(about(force, node) + "has version " + std::to_string(version) + ", but only " +
                                      std::to_string(known) +
                                      " is known; it was written by another release of openmm-helfrich");
}

inline bool boolean(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property) {
    std::string value = text(force, node, property);
    if (value != "0" && value != "1" && value != "true" && value != "false")
        refuse(force, node, property, "true or false");
    return value == "1" || value == "true";
}

/** The one child of a name. */
inline const OpenMM::SerializationNode& child(const std::string& force, const OpenMM::SerializationNode& node,
                                              const std::string& name) {
    const OpenMM::SerializationNode* found = nullptr;
    for (const OpenMM::SerializationNode& candidate : node.getChildren())
        if (candidate.getName() == name) {
            if (found != nullptr)
                throw OpenMM::OpenMMException(about(force, node) + "has the child <" + name + "> twice");
            found = &candidate;
        }
    if (found == nullptr)
        throw OpenMM::OpenMMException(about(force, node) + "lacks the child <" + name + ">");
    return *found;
}

/** Do something with an element's content; what it throws shall name the element. */
template <class Body>
void within(const std::string& force, const OpenMM::SerializationNode& node, Body body) {
    try {
        body();
    } catch (const OpenMM::OpenMMException& error) {
        std::string message = error.what();
        if (message.find("element <") != std::string::npos)
            throw;
        throw OpenMM::OpenMMException(message + " (in element <" + elementName(force, node) + ">)");
    }
}

/** The number of a constant, which XML names; one of a default may be left out. */
template <class Constant, size_t count>
Constant constantOr(const std::string& force, const OpenMM::SerializationNode& node, const std::string& property,
                    const std::string (&names)[count], Constant value) {
    if (!node.hasProperty(property))
        return value;
    auto found = std::find(std::begin(names), std::end(names), node.getStringProperty(property));
    if (found == std::end(names)) {
        std::string known = names[0];
        for (size_t i = 1; i < count; i++)
            known += (i + 1 < count ? ", " : " or ") + names[i];
        refuse(force, node, property, known);
    }
    return (Constant) (found - std::begin(names));
}

/** What all MonteCarloMovers have; the temperature must be there, with what makes a mover. */
template <class Mover>
void writeMover(const Mover& mover, OpenMM::SerializationNode& node, int version) {
    node.setIntProperty("version", version)
        .setIntProperty("forceGroup", mover.getForceGroup())
        .setStringProperty("name", mover.getName())
        .setDoubleProperty("temperature", mover.getDefaultTemperature())
        .setIntProperty("frequency", mover.getFrequency())
        .setIntProperty("randomSeed", mover.getRandomNumberSeed());
}

template <class Mover>
void readMover(const OpenMM::SerializationNode& node, Mover& mover) {
    const std::string& force = mover.getTypeName();
    mover.setForceGroup(integerOr(force, node, "forceGroup", mover.getForceGroup()));
    if (node.hasProperty("name"))
        mover.setName(text(force, node, "name"));
    mover.setFrequency(integerOr(force, node, "frequency", mover.getFrequency()));
    mover.setRandomNumberSeed(integerOr(force, node, "randomSeed", mover.getRandomNumberSeed()));
}

inline void writeTriangles(const TriangulatedForce& force, OpenMM::SerializationNode& node) {
    OpenMM::SerializationNode& triangles = node.createChildNode("Triangles");
    for (int i = 0; i < force.getNumTriangles(); i++) {
        int p1, p2, p3;
        force.getTriangle(i, p1, p2, p3);
        triangles.createChildNode("Triangle")
            .setIntProperty("p1", p1)
            .setIntProperty("p2", p2)
            .setIntProperty("p3", p3);
    }
}

inline void readTriangles(const std::string& name, const OpenMM::SerializationNode& node, TriangulatedForce& force) {
    const OpenMM::SerializationNode& triangles = child(name, node, "Triangles");
    allow(name, triangles, {}, {"Triangle"});
    for (const OpenMM::SerializationNode& element : triangles.getChildren()) {
        allow(name, element, {"p1", "p2", "p3"}, {});
        force.addTriangle(integer(name, element, "p1"), integer(name, element, "p2"), integer(name, element, "p3"));
    }
}

/** The names of the ensembles of MonteCarloSurfaceMovers, by their numbers. */
const std::string ENSEMBLES[] = {"Canonical", "Microcanonical"};

/** What all MonteCarloSurfaceMovers have. */
inline void writeSurfaceMover(const MonteCarloSurfaceMover& mover, OpenMM::SerializationNode& node, int version) {
    writeMover(mover, node, version);
    node.setDoubleProperty("attemptsPerEdge", mover.getAttemptsPerEdge())
        .setStringProperty("ensemble", ENSEMBLES[mover.getEnsemble()]);
    writeTriangles(mover, node);
}

inline void readSurfaceMover(const OpenMM::SerializationNode& node, MonteCarloSurfaceMover& mover) {
    const std::string& name = mover.getTypeName();
    readMover(node, mover);
    mover.setAttemptsPerEdge(numberOr(name, node, "attemptsPerEdge", mover.getAttemptsPerEdge()));
    mover.setEnsemble(constantOr(name, node, "ensemble", ENSEMBLES, mover.getEnsemble()));
    readTriangles(name, node, mover);
}

} // namespace xml

} // namespace HelfrichPlugin

#endif /*HELFRICH_XML_ELEMENTS_H_*/
