#include "pendcore/dynamics/chain/chain.hpp"

namespace pendcore {

template <class Number>
ChainOf<Number>::ChainOf(const Scene& scene, std::shared_ptr<ActingEffects<Pack<4>>> effects)
    : n_(static_cast<int>(scene.links.size())),
      padded_((n_ + 3) / 4 * 4),
      gravity_(scene.gravity),
      effects_(std::move(effects)) {
  const Inertia inertia(scene);
  payload_mass_ = inertia.payload_mass;
  rotor_ = inertia.rotor;
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
    const double m = link.mass;
    const double L = link.length;
    const double I = link.inertia + (i + 1 == n_ ? inertia.payload_inertia : 0.0);
    const double about_joint = I + m * link.center * link.center;
    const double apart = L - link.center;
    in(length_)[i] = L;
    in(mass_moment_)[i] = m * link.center;
    links_.push_back({.m = m,
                      .L = L,
                      .mc = m * link.center,
                      .I = I,
                      .Io = about_joint,
                      .LL = L * L,
                      .turn = about_joint - m * link.center * L,
                      .across = I + m * apart * apart});
  }
  // The first rotor turns against the ground: part of the link.
  links_[0].Io += rotor_[0];
  rotor_[0] = 0.0;
}

template class ChainOf<double>;
template class ChainOf<Dual<double>>;

}  // namespace pendcore
