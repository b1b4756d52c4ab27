#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "data/fit/bootstrap.hpp"
#include "data/fit/curve_fit.hpp"

/// One lapse rate, or guess rate, of all conditions of a person, as F. A. Wichmann and N. J. Hill
/// (Percept. Psychophys. 63:1293, 2001) advise: a person lapses as often in each, and guesses
/// alike. What the other conditions say of it enters each curve's likelihood as their own highest
/// for each rate, so that the maximum of each is that of all together, and a profile of one curve
/// is that of the joint likelihood.
namespace palpate::data {

/// Gives each model what the others say of their one rate: CurveModel::share().
/// @param models  of one person, each with spec().shared_rate()
void share_rate(std::span<CurveModel> models);

/// bootstrap() of all of a person's conditions together: each sample is fitted with one rate.
/// @param models, fits  after share_rate()
/// @param streams  of each
[[nodiscard]] std::vector<Bootstrap> shared_bootstrap(std::span<const CurveModel> models,
                                                      std::span<const CurveFit> fits,
                                                      std::size_t samples,
                                                      std::uint64_t seed,
                                                      std::span<const std::uint64_t> streams);

/// equality_p() of two of these curves, the rate being one of all under both hypotheses.
/// @param models  all of the person's
[[nodiscard]] double shared_equality_p(std::span<const CurveModel> models,
                                       std::size_t one,
                                       const CurveFit& fit_one,
                                       std::size_t two,
                                       const CurveFit& fit_two,
                                       Quantity quantity);

}  // namespace palpate::data
