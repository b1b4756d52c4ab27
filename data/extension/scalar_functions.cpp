#include <algorithm>
#include <cmath>
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

void refuse(sqlite3_context* context, const std::string& why) {
    sqlite3_result_error(context, why.c_str(), static_cast<int>(why.size()));
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

bool read_share(sqlite3_context* context, const char* name, sqlite3_value** values, Share& share) {
    if (whole(values[0], share.k) && whole(values[1], share.n) && 0 <= share.k &&
        share.k <= share.n) {
        return true;
    }
    refuse(context, fmt::format("{}: give whole numbers with 0 <= k <= n", name));
    return false;
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

void interval_function(sqlite3_context* context, int count, sqlite3_value** values) {
    const auto& function = *static_cast<const IntervalFunction*>(sqlite3_user_data(context));
    Share share;
    if (any_null(count, values) || !read_share(context, function.name, values, share)) {
        return;
    }
    const double confidence = count == 3 ? sqlite3_value_double(values[2]) : 0.95;
    if (!(confidence > 0.0 && confidence < 1.0)) {
        refuse(context, fmt::format("{}: confidence is {}: give a share between 0 and 1, as 0.95",
                                    function.name, confidence));
        return;
    }
    try {
        sqlite3_result_double(context, function.interval(share, confidence).*function.end);
    } catch (const std::exception& e) {
        refuse(context, fmt::format("{}: {}", function.name, e.what()));
    }
}

void d_prime_function(sqlite3_context* context, int count, sqlite3_value** values) {
    Share share;
    if (any_null(count, values) || !read_share(context, "d_prime", values, share)) {
        return;
    }
    std::int64_t alternatives = 0;
    constexpr std::int64_t kMax = 1000;
    if (!whole(values[2], alternatives) || alternatives < 2 || alternatives > kMax) {
        refuse(context, "d_prime: alternatives must be a whole number from 2 to 1000");
        return;
    }
    if (share.n > 0) {  // without an answer nothing is known: NULL
        sqlite3_result_double(context, d_prime(share.k, share.n, alternatives));
    }
}

/// A text that is no number would count as 0. @return false: refused
bool is_number(sqlite3_context* context, const char* name, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type == SQLITE_INTEGER || type == SQLITE_FLOAT) {
        return true;
    }
    refuse(context, fmt::format("{}: give a number, not a text", name));
    return false;
}

void probit_function(sqlite3_context* context, int count, sqlite3_value** values) {
    if (any_null(count, values) || !is_number(context, "probit", values[0])) {
        return;
    }
    const double p = sqlite3_value_double(values[0]);
    if (!(p >= 0.0 && p <= 1.0)) {
        refuse(context, fmt::format("probit: p is {}: give a share from 0 to 1", p));
        return;
    }
    sqlite3_result_double(context, protocols::normal_quantile(p));
}

void normal_cdf_function(sqlite3_context* context, int count, sqlite3_value** values) {
    if (!any_null(count, values) && is_number(context, "normal_cdf", values[0])) {
        sqlite3_result_double(context, protocols::normal_cdf(sqlite3_value_double(values[0])));
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
                     : add(db, function.name, arguments, interval_function, &function);
        }
    }
    code = code != SQLITE_OK ? code : add(db, "d_prime", 3, d_prime_function);
    code = code != SQLITE_OK ? code : add(db, "probit", 1, probit_function);
    return code != SQLITE_OK ? code : add(db, "normal_cdf", 1, normal_cdf_function);
}

}  // namespace palpate::data
