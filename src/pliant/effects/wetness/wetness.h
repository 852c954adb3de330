#pragma once

#include <vector>

#include "pliant/core/body/wettable.h"
#include "pliant/core/effect.h"
#include "pliant/effects/wetness/water_flow.h"
#include "pliant/effects/wetness/wet_contact.h"

namespace pliant {

/// Water in a cloth: w in [0, 1] of what each vertex holds when it is full. It adds mass, closes
/// the weave to air, raises friction and sticks to obstacles; it comes from a region of the scene,
/// from liquid obstacles and from users, and it drains, spreads and dries.
class WetnessEffect final : public Effect {
 public:
  struct Options {
    double wetness = 1.0;                              ///< that the region gets
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of the region [m]
    double radius = 0.0;                               ///< of the region; 0: everywhere [m]
    double from = 0.0;                                 ///< when it begins to get it [s]
    double duration = 0.0;                             ///< until it has it; 0: at once [s]
    double capacity = 0.2;                             ///< c, of water where w = 1 [kg/m²]
    double adhesion = 1440.0;                          ///< pull that w = 1 withstands [Pa]
    double adhesion_range = 1e-4;                      ///< gap up to which it pulls [m]
    double friction_factor = 2.0;                      ///< on friction where w = 1
    double permeability = 2.5e-3;                      ///< of the dry weave [m/(s Pa)]
    double drying = 0.0;                               ///< [kg/(m² s)]
    WaterFlow::Rates rates;
  };
  WetnessEffect(const EffectSite& site, Wettable& wettable, const Options& options);
  std::string_view name() const override { return "wetness"; }

  void after_step(Body& body, double dt) override;
  bool remembers_steps() const override { return true; }
  std::vector<SettableField> settable_fields() override;
  void reset(Body& body) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;

  const Eigen::VectorXd& wetness() const { return wetness_; }
  double water() const;  ///< in the whole cloth [kg]
  /// Of the weave at a vertex for air: Corey 1954, k (1 − w)² (1 − w²) [m/(s Pa)].
  double permeability(int vertex) const;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<WetnessEffect>(this, type); }

 private:
  void start(const Particles& particles);
  void sprinkle(const Particles& particles, double dt);
  void dip(const Particles& particles);
  void dry(double dt);
  Eigen::Vector3d up(const Body& body) const;
  /// What follows from the wetness of a vertex, or of all: mass, pull and friction_factor.
  void follow(int vertex);
  void follow();

  const std::vector<Obstacle>& obstacles_;
  Wettable& wettable_;
  Options options_;
  Eigen::VectorXd areas_, dry_mass_, mass_;
  WaterFlow flow_;
  Eigen::VectorXd wetness_;
  WetContact contact_;
  double time_ = 0.0;  // since the start [s]
};

EffectRegistry::Entry wetness_entry();

}  // namespace pliant
