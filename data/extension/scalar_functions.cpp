#include <algorithm>
#include <cmath>
#include <optional>
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

/// A whole number, also where it is stored as REAL (the sum of a column, say).
std::optional<std::int64_t> whole(sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    const double real = sqlite3_value_double(value);
    constexpr double kExact = 9007199254740992.0;  // 2^53
    const bool exact = std::fabs(real) <= kExact && std::floor(real) == real;
    return type == SQLITE_INTEGER || (type == SQLITE_FLOAT && exact)
             ? std::optional<std::int64_t>(sqlite3_value_int64(value))
             : std::nullopt;
}

struct Share {
    std::int64_t k = 0;
    std::int64_t n = 0;
};

Share read_share(const char* name, sqlite3_value** values) {
    const auto k = whole(values[0]);
    const auto n = whole(values[1]);
    if (!k || !n || *k < 0 || *k > *n) {
        throw Refused{fmt::format("{}: give whole numbers with 0 <= k <= n", name)};
    }
    return {*k, *n};
}

struct IntervalFunction {
    const char* name;
    Interval (*interval)(const Share& share, double confidence);
    double Interval::*end;
};

Interval wilson_at(const Share& share, double confidence) {
    return wilson(share.k, share.n, protocols::normal_quantile(0.5 + 0.5 * confidence));
}
Interval clopper_pearson_at(const Share& share, double confidence) {
    return clopper_pearson(share.k, share.n, confidence);
}

constexpr IntervalFunction kIntervals[] = {
    {"wilson_low", wilson_at, &Interval::low},
    {"wilson_high", wilson_at, &Interval::high},
    {"clopper_pearson_low", clopper_pearson_at, &Interval::low},
    {"clopper_pearson_high", clopper_pearson_at, &Interval::high},
};

/// What a function says of its arguments, of which none is NULL; nothing: NULL.
using Said = std::optional<double>;

Said interval_end(const void* data, int count, sqlite3_value** values) {
    const auto& function = *static_cast<const IntervalFunction*>(data);
    const Share share = read_share(function.name, values);
    const double confidence = count == 3 ? sqlite3_value_double(values[2]) : 0.95;
    if (!(confidence > 0.0 && confidence < 1.0)) {
        throw Refused{fmt::format("{}: confidence is {}: give a share between 0 and 1, as 0.95",
                                  function.name, confidence)};
    }
    try {
        return function.interval(share, confidence).*function.end;
    } catch (const std::exception& e) {
        throw Refused{fmt::format("{}: {}", function.name, e.what())};
    }
}

Said d_prime_of(const void* /*data*/, int /*count*/, sqlite3_value** values) {
    const Share share = read_share("d_prime", values);
    const auto alternatives = whole(values[2]);
    constexpr std::int64_t kMax = 1000;
    if (!alternatives || *alternatives < 2 || *alternatives > kMax) {
        throw Refused{"d_prime: alternatives must be a whole number from 2 to 1000"};
    }
    // Without an answer nothing is known.
    return share.n > 0 ? Said(d_prime(share.k, share.n, *alternatives)) : std::nullopt;
}

/// A text that is no number would count as 0.
double no_text(const char* name, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        throw Refused{fmt::format("{}: give a number, not a text", name)};
    }
    return sqlite3_value_double(value);
}

Said probit_of(const void* /*data*/, int /*count*/, sqlite3_value** values) {
    const double p = no_text("probit", values[0]);
    if (!(p >= 0.0 && p <= 1.0)) {
        throw Refused{fmt::format("probit: p is {}: give a share from 0 to 1", p)};
    }
    return protocols::normal_quantile(p);
}

Said normal_cdf_of(const void* /*data*/, int /*count*/, sqlite3_value** values) {
    return protocols::normal_cdf(no_text("normal_cdf", values[0]));
}

template <Said (*Function)(const void*, int, sqlite3_value**)>
void scalar(sqlite3_context* context, int count, sqlite3_value** values) {
    if (any_null(count, values)) {
        return;
    }
    try {
        if (const Said said = Function(sqlite3_user_data(context), count, values)) {
            sqlite3_result_double(context, *said);
        }
    } catch (...) {
        give_error(context);
    }
}

int add(sqlite3* db,
        const char* name,
        int arguments,
        void (*function)(sqlite3_context*, int, sqlite3_value**),
        const void* data = nullptr) {
    return sqlite3_create_function_v2(db, name, arguments,
                                      SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS,
                                      const_cast<void*>(data), function, nullptr, nullptr, nullptr);
}

}  // namespace

void give_error(sqlite3_context* context) {
    try {
        throw;
    } catch (const Refused& refused) {
        sqlite3_result_error(context, refused.why.c_str(), static_cast<int>(refused.why.size()));
    } catch (...) {
        sqlite3_result_error_nomem(context);
    }
}

bool any_null(int count, sqlite3_value** values) {
    return std::any_of(values, values + count, [](sqlite3_value* value) {
        return sqlite3_value_type(value) == SQLITE_NULL;
    });
}

int add_scalar_functions(sqlite3* db) {
    int code = SQLITE_OK;
    for (const IntervalFunction& function : kIntervals) {
        for (const int arguments : {2, 3}) {
            code = code != SQLITE_OK
                     ? code
                     : add(db, function.name, arguments, scalar<interval_end>, &function);
        }
    }
    code = code != SQLITE_OK ? code : add(db, "d_prime", 3, scalar<d_prime_of>);
    code = code != SQLITE_OK ? code : add(db, "probit", 1, scalar<probit_of>);
    return code != SQLITE_OK ? code : add(db, "normal_cdf", 1, scalar<normal_cdf_of>);
}

}  // namespace palpate::data
