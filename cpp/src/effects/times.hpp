/// \file
/// Times at which a law changes: the pieces between them, and checks of their order.
#pragma once

#include <string>
#include <vector>

namespace pendcore {

/// The piece k of t_0 <= t_1 <= ... that a run at time t is in: t_k <= t < t_{k+1} forward, t_k < t
/// <= t_{k+1} backward. The end of the times in the direction of the run belongs to the last
/// (first) piece. The result is -1 before the first time and size - 1 after the last.
int piece_at(const std::vector<double>& times, double t, bool forward);

/// The first of t_0 <= t_1 <= ... after t, or the last before t if not `forward`; infinite if there
/// is none.
double next_of(const std::vector<double>& times, double t, bool forward);

/// Throws unless the times increase; `name` is theirs.
void check_increasing(const std::string& name, const std::vector<double>& times);
/// Throws unless there are at least two times t.
void check_two_or_more(const std::string& where, const std::vector<double>& times);

}  // namespace pendcore
