#ifndef HELFRICH_DIHEDRAL_FORCE_H_
#define HELFRICH_DIHEDRAL_FORCE_H_

#include "MembraneForce.h"

namespace HelfrichPlugin {

/**
 * Stiff hinges between neighbouring triangles:
 *
 *     E = K sum over edges of f(phi)
 *
 * with phi the angle between the normals of the two triangles of an edge, 0 when flat. Unlike BendingForce
 * its effect depends on the mesh.
 *
 * Source: (B5) and the potential of fourth order of Farnudi, Ejtehadi and Everaers, Phys. Rev. E 108, 015301 (2023),
 * doi:10.1103/PhysRevE.108.015301.
 */
class DihedralForce : public MembraneForce {
public:
    /**
     * The functions of the dihedral angle phi, with c = 1 - cos phi.
     */
    enum Form {
        /**
         * f = c^2, about phi^4 / 4: the paper's potential (VCM smoothTheta4).
         */
        Quartic = 0,
        /**
         * f = c, about phi^2 / 2: Kantor and Nelson (B5) (VCM cosine).
         */
        Cosine = 1,
        /**
         * f = 1/2 (exp(2c) - 1) (VCM exp).
         */
        Exp = 2,
        /**
         * f = 0.04 (exp(10c) - 1) (VCM smoothExp).
         */
        SmoothExp = 3,
        /**
         * f = 1/2 (exp(2c) - 1 - phi^2) (VCM smoothExp46).
         */
        SmoothExp46 = 4
    };
    /**
     * @param triangles  the particle indices of the corners, three for each triangle
     * @param stiffness  the stiffness K, kJ/mol, zero or above
     * @param form  the function f
     */
    DihedralForce(const std::vector<int>& triangles, double stiffness, Form form = Quartic)
        : MembraneForce("DihedralForce", triangles, {stiffness}, form) {
    }
    /**
     * Get the stiffness K, kJ/mol.
     */
    double getStiffness() const {
        return getParameterValue("stiffness");
    }
    /**
     * Set the stiffness K, kJ/mol, zero or above.
     */
    void setStiffness(double stiffness) {
        setParameterValue("stiffness", stiffness);
    }
    /**
     * Get the function of the angle.
     */
    Form getForm() const {
        return (Form) MembraneForce::getForm();
    }
    /**
     * Set the function of the angle. updateParametersInContext() tells existing Contexts.
     */
    void setForm(Form form) {
        MembraneForce::setForm(form);
    }
};

} // namespace HelfrichPlugin

#endif /*HELFRICH_DIHEDRAL_FORCE_H_*/
