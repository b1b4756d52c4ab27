#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <sqlite3ext.h>

#include "protocols/psychometric/exact_math.hpp"
#include "data/extension/sample_module.hpp"
#include "data/statistics/distributions.hpp"
#include "data/statistics/information.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

/// What the arguments, none of them NULL, give; nothing: NULL. Throws why it is refused.
struct Scalar {
    const char* name;
    int fewest;
    int most;
    std::optional<double> (*value)(int count, sqlite3_value** values);
};

void call(sqlite3_context* context, int count, sqlite3_value** values) {
    if (any_null(count, values)) {
        return;
    }
    const auto& scalar = *static_cast<const Scalar*>(sqlite3_user_data(context));
    try {
        if (const std::optional<double> value = scalar.value(count, values)) {
            sqlite3_result_double(context, *value);
        }
    } catch (const std::exception& e) {
        const std::string why = fmt::format("{}: {}", scalar.name, e.what());
        sqlite3_result_error(context, why.c_str(), static_cast<int>(why.size()));
    }
}

/// A whole number, also where it is stored as REAL (the sum of a column, say).
bool whole(sqlite3_value* value, std::int64_t& number) {
    const int type = sqlite3_value_numeric_type(value);
    const double real = sqlite3_value_double(value);
    constexpr double kExact = 9007199254740992.0;  // 2^53
    if (type == SQLITE_FLOAT && !(std::fabs(real) <= kExact && std::floor(real) == real)) {
        return false;
    }
    number = sqlite3_value_int64(value);
    return type == SQLITE_INTEGER || type == SQLITE_FLOAT;
}

struct Share {
    std::int64_t k = 0;
    std::int64_t n = 0;
};

Share share_of(sqlite3_value** values) {
    Share share;
    if (whole(values[0], share.k) && whole(values[1], share.n) && 0 <= share.k &&
        share.k <= share.n) {
        return share;
    }
    throw std::invalid_argument("give whole numbers with 0 <= k <= n");
}

Interval wilson_at(const Share& share, double confidence) {
    return wilson(share.k, share.n, protocols::normal_quantile(0.5 + 0.5 * confidence));
}
Interval clopper_pearson_at(const Share& share, double confidence) {
    return clopper_pearson(share.k, share.n, confidence);
}

template <auto At, double Interval::*End>
std::optional<double> end_of(int count, sqlite3_value** values) {
    const Share share = share_of(values);
    const double confidence = count == 3 ? sqlite3_value_double(values[2]) : 0.95;
    if (!(confidence > 0.0 && confidence < 1.0)) {
        throw std::invalid_argument(
            fmt::format("confidence is {}: give a share between 0 and 1, as 0.95", confidence));
    }
    return At(share, confidence).*End;
}

std::optional<double> d_prime_of(int /*count*/, sqlite3_value** values) {
    const Share share = share_of(values);
    std::int64_t alternatives = 0;
    constexpr std::int64_t kMax = 1000;
    if (!whole(values[2], alternatives) || alternatives < 2 || alternatives > kMax) {
        throw std::invalid_argument("alternatives must be a whole number from 2 to 1000");
    }
    // without an answer nothing is known
    return share.n > 0 ? std::optional(d_prime(share.k, share.n, alternatives)) : std::nullopt;
}

/// A text that is no number would count as 0.
double number(sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        throw std::invalid_argument("give a number, not a text");
    }
    return sqlite3_value_double(value);
}

std::optional<double> probit_of(int /*count*/, sqlite3_value** values) {
    const double p = number(values[0]);
    if (!(p >= 0.0 && p <= 1.0)) {
        throw std::invalid_argument(fmt::format("p is {}: give a share from 0 to 1", p));
    }
    return protocols::normal_quantile(p);
}

std::optional<double> normal_cdf_of(int /*count*/, sqlite3_value** values) {
    return protocols::normal_cdf(number(values[0]));
}

constexpr Scalar kScalars[] = {
    {"wilson_low", 2, 3, end_of<wilson_at, &Interval::low>},
    {"wilson_high", 2, 3, end_of<wilson_at, &Interval::high>},
    {"clopper_pearson_low", 2, 3, end_of<clopper_pearson_at, &Interval::low>},
    {"clopper_pearson_high", 2, 3, end_of<clopper_pearson_at, &Interval::high>},
    {"d_prime", 3, 3, d_prime_of},
    {"probit", 1, 1, probit_of},
    {"normal_cdf", 1, 1, normal_cdf_of},
};

}  // namespace

bool any_null(int count, sqlite3_value** values) {
    return std::any_of(values, values + count, [](sqlite3_value* value) {
        return sqlite3_value_type(value) == SQLITE_NULL;
    });
}

int add_scalar_functions(sqlite3* db) {
    constexpr int kKind = SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS;
    int code = SQLITE_OK;
    for (const Scalar& scalar : kScalars) {
        for (int n = scalar.fewest; code == SQLITE_OK && n <= scalar.most; ++n) {
            code =
                sqlite3_create_function_v2(db, scalar.name, n, kKind, const_cast<Scalar*>(&scalar),
                                           call, nullptr, nullptr, nullptr);
        }
    }
    return code;
}

}  // namespace palpate::data
