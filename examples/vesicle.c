/*
 * A vesicle in C: read a mesh from an OFF file, simulate 1000 Verlet steps from rest, print energies.
 *
 *     vesicle MESH.off
 *
 * Build with the paths that `python -c "import openmmhelfrich as h; print(h.include_path(), h.library_path())"`
 * prints; tests/python/test_languages.py does so.
 */
#include <OpenMMHelfrichCWrapper.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void stop(const char* what) {
    fprintf(stderr, "vesicle: %s\n", what);
    exit(1);
}

/* Add a force, or say why it could not be made. */
static void add(OpenMM_System* system, OpenMM_Force* force) {
    char message[500];
    if (force == NULL) {
        Helfrich_lastError(message, sizeof message);
        stop(message);
    }
    OpenMM_System_addForce(system, force);
}

int main(int argc, char** argv) {
    int numVertices, numTriangles, i, k, corners, *triangles;
    char letter, comment[2];
    double x, y, z, *coordinates, area = 0, volume = 0;
    FILE* file = argc == 2 ? fopen(argv[1], "r") : NULL;
    if (file == NULL || fscanf(file, "OFF%c", &letter) != 1)
        stop("usage: vesicle MESH.off");
    while (fscanf(file, " %1[#]", comment) == 1)
        fscanf(file, "%*[^\n]");
    if (fscanf(file, "%d %d %*d", &numVertices, &numTriangles) != 2)
        stop("the file does not say how many vertices and triangles it has");
    coordinates = malloc(3 * numVertices * sizeof(double));
    triangles = malloc(3 * numTriangles * sizeof(int));
    OpenMM_System* system = OpenMM_System_create();
    OpenMM_Vec3Array* positions = OpenMM_Vec3Array_create(numVertices);
    for (i = 0; i < numVertices; i++) {
        double* r = coordinates + 3 * i;
        if (fscanf(file, "%lf %lf %lf", r, r + 1, r + 2) != 3)
            stop("the file ends among the vertices");
        OpenMM_Vec3 position = {r[0], r[1], r[2]};
        OpenMM_Vec3Array_set(positions, i, position);
        OpenMM_System_addParticle(system, 50.0);
    }
    for (i = 0; i < numTriangles; i++) {
        int* t = triangles + 3 * i;
        if (fscanf(file, "%d %d %d %d", &corners, t, t + 1, t + 2) != 4 || corners != 3)
            stop("the file ends among the triangles, or has other polygons");
    }
    fclose(file);

    /* The targets of area and volume are those of the mesh. */
    for (i = 0; i < numTriangles; i++) {
        double* r[3];
        for (k = 0; k < 3; k++)
            r[k] = coordinates + 3 * triangles[3 * i + k];
        x = (r[1][1] - r[0][1]) * (r[2][2] - r[0][2]) - (r[1][2] - r[0][2]) * (r[2][1] - r[0][1]);
        y = (r[1][2] - r[0][2]) * (r[2][0] - r[0][0]) - (r[1][0] - r[0][0]) * (r[2][2] - r[0][2]);
        z = (r[1][0] - r[0][0]) * (r[2][1] - r[0][1]) - (r[1][1] - r[0][1]) * (r[2][0] - r[0][0]);
        area += 0.5 * sqrt(x * x + y * y + z * z);
        volume += (r[0][0] * x + r[0][1] * y + r[0][2] * z) / 6;
    }
    add(system, Helfrich_BendingForce_create(triangles, numTriangles, 50.0, 0.0, Helfrich_BendingForce_Julicher));
    add(system, Helfrich_SurfaceAreaForce_create(triangles, numTriangles, 1.3, area));
    add(system, Helfrich_EnclosedVolumeForce_create(triangles, numTriangles, 0.04, volume));
    add(system, Helfrich_TriangleHeightForce_create(triangles, numTriangles, 20.0, 9.977));

    OpenMM_VerletIntegrator* integrator = OpenMM_VerletIntegrator_create(0.2);
    /* OpenMM chooses the platform Helfrich, which it knows of now. */
    Helfrich_register();
    OpenMM_Context* context = OpenMM_Context_create(system, (OpenMM_Integrator*) integrator);
    printf("# platform %s\n", OpenMM_Platform_getName(OpenMM_Context_getPlatform(context)));
    OpenMM_Context_setPositions(context, positions);
    for (i = 0; i <= 1000; i += 500) {
        OpenMM_State* state = OpenMM_Context_getState(context, OpenMM_State_Energy, 0);
        printf("%d %.10g %.10g\n", i, OpenMM_State_getPotentialEnergy(state), OpenMM_State_getKineticEnergy(state));
        OpenMM_State_destroy(state);
        if (i < 1000)
            OpenMM_VerletIntegrator_step(integrator, 500);
    }
    OpenMM_Context_destroy(context);
    OpenMM_VerletIntegrator_destroy(integrator);
    OpenMM_System_destroy(system);
    OpenMM_Vec3Array_destroy(positions);
    free(coordinates);
    free(triangles);
    return 0;
}
