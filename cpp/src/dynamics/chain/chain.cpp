#include "dynamics/chain/chain.hpp"

namespace pendcore {

template <class Number>
ChainOf<Number>::ChainOf(const Scene& scene, std::shared_ptr<EffectsInRows<Pack<4>>> effects)
    : n_(static_cast<int>(scene.links.size())),
      padded_((n_ + width - 1) / width * width),
      gravity_(scene.gravity),
      effects_(std::move(effects)) {
  const Inertia inertia(scene);
  payload_mass_ = inertia.payload_mass;
  rotor_ = inertia.rotors_between_links();
  for (int i = 1; i < n_; ++i) has_rotors_ |= rotor_[i] != 0.0;
  loaded_ = !effects_->couples.empty() || !effects_->entries.empty() || !effects_->users.empty() ||
            !effects_->pivots.empty();

  const std::size_t room = padded_ + 8;
  for (std::vector<double>* array : {&length_, &mass_moment_}) array->assign(room, 0.0);
  for (std::vector<Number>* array :
       {&q_, &qd_, &s_, &c_, &centripetal_, &center_, &cc_, &ss_, &sc_, &cos_, &sin_, &couple_,
        &torque_, &fx_, &fy_, &vx_, &vy_, &user_}) {
    array->assign(room, Number{});
  }
  in(c_)[-1] = 1.0;
  response_.resize(n_);
  for (int i = 0; i < n_; ++i) {
    const Link& link = scene.links[i];
    in(length_)[i] = link.length;
    in(mass_moment_)[i] = link.mass * link.center;
  }
  links_ = chain_links(scene, inertia);
}

// The kernels instantiate the rest.
template ChainOf<double>::ChainOf(const Scene&, std::shared_ptr<EffectsInRows<Pack<4>>>);
template ChainOf<Dual<double>>::ChainOf(const Scene&, std::shared_ptr<EffectsInRows<Pack<4>>>);
template ChainOf<Dual<double, Pack<4>>>::ChainOf(const Scene&,
                                                 std::shared_ptr<EffectsInRows<Pack<4>>>);
template ChainOf<Dual<double, Pack<8>>>::ChainOf(const Scene&,
                                                 std::shared_ptr<EffectsInRows<Pack<4>>>);

}  // namespace pendcore
