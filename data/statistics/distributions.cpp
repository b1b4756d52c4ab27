#include "data/statistics/distributions.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/beta.hpp>

namespace palpate::data {

double t_quantile(double p, double df) {
    return boost::math::quantile(boost::math::students_t(df), p);
}

double t_two_sided(double t, double df) {
    return 2.0 * boost::math::cdf(complement(boost::math::students_t(df), std::fabs(t)));
}

double chi_square_p(double x, int df) {
    return boost::math::cdf(complement(boost::math::chi_squared(df), std::max(x, 0.0)));
}

double beta_quantile(double a, double b, double p) {
    return boost::math::ibeta_inv(a, b, p);
}

double beta_upper_quantile(double a, double b, double p) {
    return boost::math::ibetac_inv(a, b, p);
}

}  // namespace palpate::data
