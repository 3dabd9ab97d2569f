#include "pendcore/effects/registry.hpp"

namespace pendcore {

namespace {

template <std::size_t... kinds>
bool assign_kind(std::string_view kind, Effect& effect, std::index_sequence<kinds...>) {
  return ((std::variant_alternative_t<kinds, Effect>::info.kind == kind
               ? (effect = std::variant_alternative_t<kinds, Effect>{}, true)
               : false) ||
          ...);
}

}  // namespace

Effect effect_of_kind(std::string_view kind) {
  Effect effect;
  if (!assign_kind(kind, effect, std::make_index_sequence<std::variant_size_v<Effect>>{})) {
    throw std::invalid_argument("kind = \"" + std::string(kind) + "\": there is no such effect");
  }
  return effect;
}

std::optional<double> holding_torque(const Effect& effect) {
  return std::visit(
      []<class Kind>(const Kind& one) -> std::optional<double> {
        if constexpr (HasHoldingTorque<Kind>) return one.holding_torque();
        return std::nullopt;
      },
      effect);
}

void check_effect(const std::string& where, const Effect& effect) {
  std::visit([&](const auto& one) { check_parameters(where, one); }, effect);
}

}  // namespace pendcore
