/// \file
/// The sums of products in two orders of the series of three and four links
/// (few_links_series.hpp). Two orders are computed at a time, so that what their sums share is
/// loaded once. The sums by age of two links (terms_by_age.hpp) gain nothing here: single runs of
/// three and four links take 1.00 to 1.05 of the time with them, lanes 1.2 to 1.7.
#pragma once

#include "arithmetic/pair.hpp"

namespace pendcore {

/// The terms of the sums of orders k and k + 1 that are known before both: of qd_j n_{k+1-j}, and
/// of n_{k-j} times the pulls.
template <class Value>
struct KnownTerms {
  Value along{}, across{}, next_along{}, next_across{};
};

/// Adds up the known terms of orders k >= 2 and k + 1 of the numbers that `pull(j)`, `rate(j)` and
/// `n(j)` return.
template <class Value, class Pull, class Rate, class Normal>
PENDCORE_INLINE KnownTerms<Value> known_terms(int k, const Pull& pull, const Rate& rate,
                                              const Normal& n) {
  KnownTerms<Value> sum;
  auto rate_here = rate(1);
  Value pull_here = pull(0);
  for (int i = k; i >= 2; --i) {
    const Value n_here = n(i);
    sum.along = fma(rate_here, n_here, sum.along);
    sum.across = fma(pull_here, n_here, sum.across);
    rate_here = rate(k + 2 - i);
    pull_here = pull(k + 1 - i);
    sum.next_along = fma(rate_here, n_here, sum.next_along);
    sum.next_across = fma(pull_here, n_here, sum.next_across);
  }
  const Value n_last = n(k + 1);
  sum.along = fma(rate_here, n(1), fma(rate(0), n_last, sum.along));
  sum.across = fma(pull_here, n(1), sum.across);
  sum.next_along = fma(rate(1), n_last, sum.next_along);
  sum.next_across = fma(pull(0), n_last, sum.next_across);
  return sum;
}

}  // namespace pendcore
