/// \file
/// The tangent space of a chain's state: the small changes (dq, dqd) that locks allow, and their
/// lengths.
///
/// Links that are locked to each other turn together; those locked to the ground do not turn. The m
/// groups of links that turn together give an orthonormal basis: a change of each group's angles,
/// and a change of its rates.
#pragma once

#include <vector>

#include "pendcore/scene.hpp"

namespace pendcore {

/// An orthonormal basis, (2m, 2n) row-major, each row a change (dq, dqd). Changes of angles come
/// first.
std::vector<double> tangent_basis(const Scene& scene);

/// Makes the rows of `vectors`, (k, size) row-major, orthonormal by the Gram-Schmidt process,
/// applied twice so that it is exact to rounding. The rows of `alike` go through the same linear
/// combinations. `length` (k) becomes the diagonal of R: the length of each row without its
/// components along the rows before.
void orthonormalise(int k, int size, double* vectors, double* alike, double* length);

}  // namespace pendcore
