/* What a C program sets it can read, and connectivity goes on in another Context; tests/python/test_languages.py. */

#include <OpenMMHelfrichCWrapper.h>
#include <stdio.h>
#include <stdlib.h>

static const int corners[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

/* The message of the last failure, in a line. */
static void complain(int failed) {
    char message[400];
    Helfrich_lastError(message, sizeof(message));
    printf("%d %s\n", failed, message);
}

static OpenMM_Context* context_of(OpenMM_Force** bending, OpenMM_Force** mover, OpenMM_Integrator* integrator) {
    OpenMM_System* system = OpenMM_System_create();
    OpenMM_Vec3Array* places = OpenMM_Vec3Array_create(6);
    for (int i = 0; i < 6; i++) {
        OpenMM_Vec3 place = {0, 0, 0};
        (&place.x)[i / 2] = i % 2 ? -10 : 10;
        OpenMM_Vec3Array_set(places, i, place);
        OpenMM_System_addParticle(system, 50);
    }
    *bending = Helfrich_BendingForce_create(corners, 8, 5.0, 0.0, 1);
    OpenMM_System_addForce(system, *bending);
    *mover = Helfrich_MonteCarloBondFlip_create(corners, 8, 3000, 1, 1.0, 3, 9, 0);
    if (Helfrich_VariableMassVerletIntegrator_getDensity(integrator) >= 0)
        Helfrich_MembraneForce_destroy(*mover);
    else
        OpenMM_System_addForce(system, *mover);
    OpenMM_Context* context = OpenMM_Context_create(system, integrator);
    OpenMM_Context_setPositions(context, places);
    return context;
}

int main(void) {
    Helfrich_register();
    OpenMM_Force *bending, *mover;
    double values[6] = {1, 2, 3, 4, 5, 6}, found[6];
    OpenMM_Integrator* varying = Helfrich_VariableMassVerletIntegrator_create(0.01, 2.0);
    OpenMM_Context* one = context_of(&bending, &mover, varying);
    OpenMM_Integrator_step(varying, 5);
    Helfrich_VariableMassVerletIntegrator_getMasses(varying, found);
    printf("%.0f ", found[3]);
    printf("%g ", Helfrich_VariableMassVerletIntegrator_getDensity(varying));
    printf("%d ", Helfrich_MembraneForce_getForm(bending));
    printf("%d ", Helfrich_MembraneForce_getNumElementValues(bending, "rigidity"));
    Helfrich_MembraneForce_setElementValues(bending, "rigidity", values, 6);
    printf("%d ", Helfrich_MembraneForce_getNumElementValues(bending, "rigidity"));
    Helfrich_MembraneForce_getElementValues(bending, "rigidity", found);
    const char* name = "unsignedSpontaneousCurvature";
    Helfrich_MembraneForce_setSwitch(bending, name, 1);
    printf("%g %d\n", found[5], Helfrich_MembraneForce_getSwitch(bending, name));
    OpenMM_Context_destroy(one);
    OpenMM_Integrator* warm = Helfrich_VariableMassLangevinIntegrator_create(300, 1, 0.01, 0);
    Helfrich_VariableMassLangevinIntegrator_setRandomNumberSeed(warm, 7);
    printf("%g ", Helfrich_VariableMassLangevinIntegrator_getTemperature(warm));
    printf("%d ", Helfrich_VariableMassLangevinIntegrator_getRandomNumberSeed(warm));
    printf("%d\n", Helfrich_VariableMassVerletIntegrator_setDensity(warm, 1));
    OpenMM_Integrator* verlet = (OpenMM_Integrator*) OpenMM_VerletIntegrator_create(0.001);
    OpenMM_Context* two = context_of(&bending, &mover, verlet);
    OpenMM_Integrator_step(verlet, 20);
    int now[24], then[24];
    Helfrich_MembraneForce_getTrianglesInContext(bending, two, now);
    int64_t size = Helfrich_MembraneForce_saveConnectivity(bending, two, NULL, 0);
    char* saved = malloc(size);
    Helfrich_MembraneForce_saveConnectivity(bending, two, saved, size);
    OpenMM_Context* three = context_of(&bending, &mover, (OpenMM_Integrator*) OpenMM_VerletIntegrator_create(0.001));
    int status = Helfrich_MembraneForce_restoreConnectivity(bending, three, saved, size);
    Helfrich_MembraneForce_getTrianglesInContext(bending, three, then);
    int same = 1, moved = 0;
    for (int i = 0; i < 24; i++)
        same &= now[i] == then[i], moved |= now[i] != corners[i];
    printf("%d %d %d ", status, same, moved);
    saved[size / 2] ^= 1;
    printf("%d\n", Helfrich_MembraneForce_restoreConnectivity(bending, three, saved, size));
    OpenMM_Force* thick = Helfrich_SurfaceViscosityThermostat_create(corners, 8, 1, 300, 1);
    complain(Helfrich_SurfaceViscosityThermostat_saveState(thick, two, NULL, 8) == -1);
    OpenMM_Force* none = Helfrich_SurfaceAreaForce_create(corners, 8, 1.0, 0.0);
    complain(none == NULL);
    complain(Helfrich_MembraneForce_setUsesPeriodicBoundaryConditions(none, 1));
    complain(Helfrich_MembraneForce_updateParametersInContext(bending, NULL));
    complain(Helfrich_MembraneForce_setElementValues(bending, "rigidity", NULL, 6));
    complain(Helfrich_MembraneForce_setElementValues(bending, "rigidity", values, -3));
    complain(Helfrich_MembraneForce_setElementValues(bending, NULL, values, 6));
    complain(Helfrich_VariableMassVerletIntegrator_setDensity(NULL, 1));
    return 0;
}
