// A vesicle in C++: read a mesh from an OFF file, simulate 1000 Verlet steps from rest, print energies.
//
//     vesicle MESH.off
//
// Build with the paths that `python -c "import openmmhelfrich as h; print(h.include_path(), h.library_path())"`
// prints, or with CMake's find_package(OpenMMHelfrich); tests/python/test_languages.py does so.
#include <OpenMM.h>
#include <OpenMMHelfrich.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>

using namespace HelfrichPlugin;
using OpenMM::Vec3;

int main(int argc, char** argv) {
    try {
        std::ifstream file(argc == 2 ? argv[1] : "");
        std::string off;
        int numVertices, numTriangles, numEdges, corners;
        std::getline(file, off);
        while ((file >> std::ws).peek() == '#')
            file.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
        if (!(file >> numVertices >> numTriangles >> numEdges) || off != "OFF")
            throw std::runtime_error("usage: vesicle MESH.off");
        std::vector<Vec3> positions(numVertices);
        OpenMM::System system;
        for (Vec3& position : positions) {
            file >> position[0] >> position[1] >> position[2];
            system.addParticle(50.0);
        }
        std::vector<int> triangles(3 * numTriangles);
        for (int i = 0; i < numTriangles; i++)
            file >> corners >> triangles[3 * i] >> triangles[3 * i + 1] >> triangles[3 * i + 2];
        if (!file)
            throw std::runtime_error("the file is truncated");

        // The targets of area and volume are those of the mesh.
        double area = 0, volume = 0;
        for (int i = 0; i < numTriangles; i++) {
            Vec3 a = positions[triangles[3 * i]];
            Vec3 normal = (positions[triangles[3 * i + 1]] - a).cross(positions[triangles[3 * i + 2]] - a);
            area += 0.5 * std::sqrt(normal.dot(normal));
            volume += a.dot(normal) / 6;
        }
        system.addForce(new BendingForce(triangles, 50.0));
        system.addForce(new SurfaceAreaForce(triangles, 1.3, area));
        system.addForce(new EnclosedVolumeForce(triangles, 0.04, volume));
        system.addForce(new TriangleHeightForce(triangles, 20.0, 9.977));

        OpenMM::VerletIntegrator integrator(0.2);
        // OpenMM chooses the platform Helfrich, which it knows of now.
        Helfrich_register();
        OpenMM::Context context(system, integrator);
        std::printf("# platform %s\n", context.getPlatform().getName().c_str());
        context.setPositions(positions);
        for (int step = 0; step <= 1000; step += 500) {
            OpenMM::State state = context.getState(OpenMM::State::Energy);
            std::printf("%d %.10g %.10g\n", step, state.getPotentialEnergy(), state.getKineticEnergy());
            if (step < 1000)
                integrator.step(500);
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "vesicle: " << error.what() << "\n";
        return 1;
    }
}
