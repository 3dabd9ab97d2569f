#include "dynamics/tangent_space.hpp"

#include <cmath>

#include "pendcore/effects/lock.hpp"

namespace pendcore {

std::vector<double> tangent_basis(const Scene& scene) {
  const int n = static_cast<int>(scene.links.size());
  std::vector<char> locked(n);
  for (const Lock& lock : effects_of<Lock>(scene)) locked[lock.joint - 1] = 1;
  std::vector<double> basis;
  for (const int part : {0, n}) {
    for (int first = 0; first < n;) {
      int end = first + 1;
      while (end < n && locked[end] != 0) ++end;
      if (locked[first] == 0) {
        const std::size_t row = basis.size();
        basis.resize(row + 2 * static_cast<std::size_t>(n));
        for (int i = first; i < end; ++i) basis[row + part + i] = 1.0 / std::sqrt(end - first);
      }
      first = end;
    }
  }
  return basis;
}

void orthonormalise(int k, int size, double* vectors, double* alike, double* length) {
  auto dot = [size](const double* a, const double* b) {
    double sum = 0.0;
    for (int i = 0; i < size; ++i) sum += a[i] * b[i];
    return sum;
  };
  for (int j = 0; j < k; ++j) {
    double* const v = vectors + j * size;
    double* const w = alike + j * size;
    for (int pass = 0; pass < 2; ++pass) {
      for (int before = 0; before < j; ++before) {
        const double along = dot(v, vectors + before * size);
        for (int i = 0; i < size; ++i) {
          v[i] -= along * vectors[before * size + i];
          w[i] -= along * alike[before * size + i];
        }
      }
    }
    length[j] = std::sqrt(dot(v, v));
    for (int i = 0; i < size; ++i) {
      v[i] /= length[j];
      w[i] /= length[j];
    }
  }
}

}  // namespace pendcore
