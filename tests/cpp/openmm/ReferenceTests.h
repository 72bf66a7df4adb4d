// What the C++ tests of OpenMM's repository include to learn the platform that they are about. Theirs is
// Reference; here it is the one that the environment names, once the plugin is loaded. See tests/openmm_cpp_suite.py.

#ifndef REFERENCE_TESTS_H_
#define REFERENCE_TESTS_H_

#include <ReferencePlatform.h>
#include <openmm/Context.h>
#include <openmm/Platform.h>

#include <cstdlib>
#include <string>

/** Stands where tests have an object of a platform's class. */
class TestedPlatform {
public:
    TestedPlatform() : tested(find()) {
    }
    operator OpenMM::Platform&() {
        return tested;
    }
    /** Tests of plugins take Reference here once more. */
    TestedPlatform& operator=(const OpenMM::Platform&) {
        return *this;
    }
    const std::string& getName() const {
        return tested.getName();
    }
    const std::string& getPropertyValue(const OpenMM::Context& context, const std::string& property) const {
        return tested.getPropertyValue(context, property);
    }
    const std::string& getPropertyDefaultValue(const std::string& property) const {
        return tested.getPropertyDefaultValue(property);
    }

private:
    static OpenMM::Platform& find() {
        OpenMM::Platform::loadPluginLibrary(std::getenv("HELFRICH_LIBRARY"));
        return OpenMM::Platform::getPlatformByName(std::getenv("HELFRICH_TESTED_PLATFORM"));
    }
    OpenMM::Platform& tested;
};

TestedPlatform platform;

void initializeTests(int, char*[]) {
}

#endif /*REFERENCE_TESTS_H_*/
