#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sqlite3ext.h>

#include "data/analysis/information.hpp"
#include "data/extension/functions.hpp"

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

/// Why a row cannot be taken, in the words of the function's name.
struct Refused {
    std::string why;
};

double number(const char* name, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        throw Refused{fmt::format("{}: \"{}\" is no number", name,
                                  reinterpret_cast<const char*>(sqlite3_value_text(value)))};
    }
    return sqlite3_value_double(value);
}

/// What a quantile is taken of.
class Quantile {
public:
    void add(int count, sqlite3_value** values) {
        values_.push_back(number(count == 1 ? "median" : "quantile", values[0]));
        const double share = count == 1 ? 0.5 : number("quantile", values[1]);
        if (!(share >= 0.0 && share <= 1.0) || (values_.size() > 1 && share != share_)) {
            throw Refused{"quantile: give one share from 0 to 1 for all rows, as quantile(x, 0.9)"};
        }
        share_ = share;
    }
    [[nodiscard]] std::optional<double> value() {
        if (values_.empty()) {
            return std::nullopt;  // its first row was refused
        }
        const double place = share_ * static_cast<double>(values_.size() - 1);
        const auto below = static_cast<std::ptrdiff_t>(std::floor(place));
        const auto at = values_.begin() + below;
        std::nth_element(values_.begin(), at, values_.end());
        const double part = place - static_cast<double>(below);
        if (part == 0.0) {
            return *at;
        }
        const double next = *std::min_element(at + 1, values_.end());
        return *at + part * (next - *at);
    }

private:
    std::vector<double> values_;
    double share_ = 0.5;
};

class GeometricMean {
public:
    void add(int /*count*/, sqlite3_value** values) {
        const double x = number("geometric_mean", values[0]);
        if (!(x > 0.0)) {
            throw Refused{fmt::format("geometric_mean: {} is not above 0: leave such rows out", x)};
        }
        sum_ += std::log(x);
        n_ += 1.0;
    }
    [[nodiscard]] std::optional<double> value() const { return std::exp(sum_ / n_); }

private:
    double sum_ = 0.0;
    double n_ = 0.0;
};

class StandardDeviation {
public:
    void add(int /*count*/, sqlite3_value** values) {
        const double x = number("stddev_samp", values[0]);
        n_ += 1.0;
        const double before = x - mean_;
        mean_ += before / n_;
        squares_ += before * (x - mean_);
    }
    [[nodiscard]] std::optional<double> value() const {
        return n_ < 2.0 ? std::nullopt : std::optional(std::sqrt(squares_ / (n_ - 1.0)));
    }

private:
    double n_ = 0.0;
    double mean_ = 0.0;
    double squares_ = 0.0;
};

class ShareOf {
public:
    void add(int /*count*/, sqlite3_value** values) {
        hits_ += number("share", values[0]) != 0.0 ? 1.0 : 0.0;
        n_ += 1.0;
    }
    [[nodiscard]] std::optional<double> value() const { return hits_ / n_; }

private:
    double hits_ = 0.0;
    double n_ = 0.0;
};

template <double Information::*Kind>
class Transmitted {
public:
    void add(int count, sqlite3_value** values) {
        const double n = count == 3 ? number("mutual_information", values[2]) : 1.0;
        if (!(n >= 0.0 && n < 1e15 && std::floor(n) == n)) {
            throw Refused{fmt::format(
                "mutual_information: n is {}: give how often, a whole number from 0", n)};
        }
        counts_[{text(values[0]), text(values[1])}] += static_cast<std::int64_t>(n);
    }
    [[nodiscard]] std::optional<double> value() const { return mutual_information(counts_).*Kind; }

private:
    static std::string text(sqlite3_value* value) {
        const auto* bytes = static_cast<const char*>(sqlite3_value_blob(value));
        const auto size = static_cast<std::size_t>(sqlite3_value_bytes(value));
        return bytes == nullptr ? std::string() : std::string(bytes, size);
    }

    ConfusionCounts counts_;
};

/// SQLite keeps one pointer a group; the first row makes what it points to.
template <class Aggregate>
Aggregate** state(sqlite3_context* context, int bytes) {
    return static_cast<Aggregate**>(sqlite3_aggregate_context(context, bytes));
}

template <class Aggregate>
void step(sqlite3_context* context, int count, sqlite3_value** values) {
    for (int i = 0; i < count; ++i) {
        if (sqlite3_value_type(values[i]) == SQLITE_NULL) {
            return;
        }
    }
    auto** aggregate = state<Aggregate>(context, sizeof(Aggregate*));
    if (aggregate == nullptr) {
        sqlite3_result_error_nomem(context);
        return;
    }
    try {
        if (*aggregate == nullptr) {
            *aggregate = new Aggregate;
        }
        (*aggregate)->add(count, values);
    } catch (const Refused& refused) {
        sqlite3_result_error(context, refused.why.c_str(), static_cast<int>(refused.why.size()));
    } catch (const std::exception&) {
        sqlite3_result_error_nomem(context);
    }
}

template <class Aggregate>
void finish(sqlite3_context* context) {
    auto** aggregate = state<Aggregate>(context, 0);
    if (aggregate == nullptr || *aggregate == nullptr) {
        return;
    }
    if (const auto value = (*aggregate)->value()) {
        sqlite3_result_double(context, *value);
    }
    delete *aggregate;
}

template <class Aggregate>
int add(sqlite3* db, const char* name, int arguments) {
    return sqlite3_create_function_v2(
        db, name, arguments, SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS, nullptr,
        nullptr, step<Aggregate>, finish<Aggregate>, nullptr);
}

/// R's SQLite brings a median of its own, the same one. SQLite says busy there, since the statement that
/// loads this is running; then theirs stays.
int add_median(sqlite3* db) {
    const int code = add<Quantile>(db, "median", 1);
    return (code & 0xFF) == SQLITE_BUSY ? SQLITE_OK : code;
}

}  // namespace

int add_aggregate_functions(sqlite3* db) {
    using PlugIn = Transmitted<&Information::plug_in>;
    using MillerMadow = Transmitted<&Information::miller_madow>;
    const int codes[] = {
        add_median(db),
        add<Quantile>(db, "quantile", 2),
        add<GeometricMean>(db, "geometric_mean", 1),
        add<StandardDeviation>(db, "stddev_samp", 1),
        add<ShareOf>(db, "share", 1),
        add<PlugIn>(db, "mutual_information", 2),
        add<PlugIn>(db, "mutual_information", 3),
        add<MillerMadow>(db, "mutual_information_miller_madow", 2),
        add<MillerMadow>(db, "mutual_information_miller_madow", 3),
    };
    const auto* const failed = std::find_if(std::begin(codes), std::end(codes),
                                            [](int code) { return code != SQLITE_OK; });
    return failed == std::end(codes) ? SQLITE_OK : *failed;
}

}  // namespace palpate::data
