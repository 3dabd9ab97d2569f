/// \file
/// The vectors and matrices of the API are Eigen's.
///
/// What the library returns owns memory of malloc (Eigen::DontAlign), so that a program may free it
/// whatever instruction set (-march) either of the two is compiled for.
#pragma once

#include <concepts>
#include <Eigen/Core>
#include <initializer_list>
#include <span>
#include <utility>
#include <vector>

namespace pendcore {

using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::DontAlign>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic,  //
                             Eigen::RowMajor | Eigen::DontAlign>;
/// A row x, y for each point; x right, y down.
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor | Eigen::DontAlign>;

/// Numbers that belong to something else.
using View = Eigen::Map<const Eigen::VectorXd>;

/// The argument of a function that takes a vector: one of Eigen's, whatever a std::span can view
/// (std::vector, std::array), or numbers in braces. Only vectors with gaps and expressions are
/// copied.
class Numbers : public Eigen::Ref<const Vector> {
 public:
  using Ref = Eigen::Ref<const Vector>;
  using Ref::Ref;
  Numbers(std::span<const double> numbers)  // NOLINT(google-explicit-constructor)
      : Ref(View(numbers.data(), static_cast<Eigen::Index>(numbers.size()))) {}
  template <std::convertible_to<std::span<const double>> Container>
  Numbers(const Container& numbers)  // NOLINT(google-explicit-constructor)
      : Numbers(std::span<const double>(numbers)) {}
  Numbers(std::initializer_list<double> numbers)
      : Numbers(std::span(numbers.begin(), numbers.size())) {}
  Numbers(const Numbers&) = delete;
  Numbers& operator=(const Numbers&) = delete;
  ~Numbers() = default;

  /// The same numbers for what works without Eigen.
  std::span<const double> span() const { return {data(), static_cast<std::size_t>(size())}; }
};

/// A std::vector that may be given as all that Numbers may be given as.
class NumberList : public std::vector<double> {
 public:
  NumberList() = default;
  NumberList(std::initializer_list<double> each) : std::vector<double>(each) {}
  NumberList(std::vector<double> each)  // NOLINT(google-explicit-constructor)
      : std::vector<double>(std::move(each)) {}
  template <std::convertible_to<Numbers> Container>
  NumberList(const Container& each)  // NOLINT(google-explicit-constructor)
      : NumberList(Numbers(each)) {}

 private:
  explicit NumberList(const Numbers& each)
      : std::vector<double>(each.data(), each.data() + each.size()) {}
};

}  // namespace pendcore
