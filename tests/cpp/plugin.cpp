/**
 * The plugin as a C++ program meets it: it comes from a folder, and forces come from XML.
 *
 *     plugin DIRECTORY SYSTEM POSITIONS
 *
 * loads all plugins in DIRECTORY, or in OpenMM's default one if it is "default", reads a System from XML
 * and the coordinates of its particles from a text file, and prints what it finds, one word and its value
 * a line: each library that was loaded and each that failed to, then for each platform that runs on the
 * processor the energy of each force group, or the message of the exception. tests/python/test_plugin_cpp.py
 * compiles and runs it.
 */

#include <OpenMM.h>
#include <openmm/serialization/XmlSerializer.h>

#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

using namespace OpenMM;

namespace {

std::ifstream open(const std::string& path) {
    std::ifstream file(path);
    if (!file)
        throw std::runtime_error("cannot read " + path);
    return file;
}

std::vector<Vec3> readPositions(const std::string& path) {
    std::ifstream file = open(path);
    std::vector<Vec3> positions;
    double x, y, z;
    while (file >> x >> y >> z)
        positions.emplace_back(x, y, z);
    return positions;
}

void printEnergies(const System& system, const std::vector<Vec3>& positions, const char* platform) {
    try {
        VerletIntegrator integrator(0.1);
        Context context(system, integrator, Platform::getPlatform(platform));
        context.setPositions(positions);
        for (int i = 0; i < system.getNumForces(); i++) {
            int group = system.getForce(i).getForceGroup();
            double energy = context.getState(State::Energy, false, 1 << group).getPotentialEnergy();
            std::printf("energy %s %d %.17g\n", platform, group, energy);
        }
    } catch (const OpenMMException& error) {
        std::printf("error %s %s\n", platform, error.what());
    }
}

} // namespace

int main(int count, char** arguments) {
    if (count != 4) {
        std::fprintf(stderr, "usage: plugin DIRECTORY SYSTEM POSITIONS\n");
        return 2;
    }
    try {
        std::string directory = arguments[1];
        if (directory == "default")
            directory = Platform::getDefaultPluginsDirectory();
        for (const std::string& path : Platform::loadPluginsFromDirectory(directory))
            std::printf("loaded %s\n", path.c_str());
        for (const std::string& failure : Platform::getPluginLoadFailures())
            std::printf("failure %s\n", failure.c_str());
        std::ifstream xml = open(arguments[2]);
        std::unique_ptr<System> system(XmlSerializer::deserialize<System>(xml));
        std::vector<Vec3> positions = readPositions(arguments[3]);
        for (int i = 0; i < Platform::getNumPlatforms(); i++) {
            std::string name = Platform::getPlatform(i).getName();
            if (name == "Reference" || name == "CPU" || name == "Helfrich")
                printEnergies(*system, positions, name.c_str());
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "plugin: %s\n", error.what());
        return 1;
    }
    return 0;
}
