/// \file
/// Small changes (dq, dqd) of a chain's state: which there are, and how long they are.
///
/// The links that locks make one turn alike, those locked to the ground not at all. So the changes
/// that there are have an orthonormal basis of the m groups of links that turn together: a change
/// of the group's angles, or of its rates.
#pragma once

#include <vector>

#include "pendcore/scene/scene.hpp"

namespace pendcore {

/// Orthonormal changes, (2m, 2n) row-major, a row (dq, dqd) each: first those of the angles.
std::vector<double> tangent_basis(const Scene& scene);

/// Makes the rows of `vectors`, (k, 2n) row-major, orthonormal, one after the other (Gram and
/// Schmidt, twice, which is exact to rounding), and multiplies the same combinations into the rows
/// of `alike`. `length` (k) becomes what each was long, less what lay along those before it: the
/// diagonal of R.
void orthonormalise(int k, int size, double* vectors, double* alike, double* length);

}  // namespace pendcore
