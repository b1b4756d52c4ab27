#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <sqlite3ext.h>

#include "data/extension/sample_module.hpp"
#include "data/statistics/information.hpp"
#include "data/statistics/paired.hpp"

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

/// The values of a group, or of a window's frame: what came first leaves first. A frame is computed
/// anew for each of its rows, so that a window says to the bit what the same rows say as a group.
class Rows {
public:
    void remove(int /*count*/, sqlite3_value** /*values*/) {
        if (++first_ > values_.size() / 2) {
            values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(first_));
            first_ = 0;
        }
    }

protected:
    void take(double x) { values_.push_back(x); }
    [[nodiscard]] std::span<const double> all() const { return std::span(values_).subspan(first_); }

private:
    std::vector<double> values_;
    std::size_t first_ = 0;
};

/// What a quantile is taken of.
class Quantile : public Rows {
public:
    void add(int count, sqlite3_value** values) {
        const double x = number(count == 1 ? "median" : "quantile", values[0]);
        const double share = count == 1 ? 0.5 : number("quantile", values[1]);
        if (!(share >= 0.0 && share <= 1.0) || (!all().empty() && share != share_)) {
            throw Refused{"quantile: give one share from 0 to 1 for all rows, as quantile(x, 0.9)"};
        }
        take(x);
        share_ = share;
    }
    [[nodiscard]] std::optional<double> value() const {
        std::vector<double> values(all().begin(), all().end());
        if (values.empty()) {
            return std::nullopt;
        }
        const double place = share_ * static_cast<double>(values.size() - 1);
        const auto below = static_cast<std::ptrdiff_t>(std::floor(place));
        const auto at = values.begin() + below;
        std::nth_element(values.begin(), at, values.end());
        const double part = place - static_cast<double>(below);
        if (part == 0.0) {
            return *at;
        }
        const double next = *std::min_element(at + 1, values.end());
        return *at + part * (next - *at);
    }

private:
    double share_ = 0.5;
};

class GeometricMean : public Rows {
public:
    void add(int /*count*/, sqlite3_value** values) {
        const double x = number("geometric_mean", values[0]);
        if (!(x > 0.0)) {
            throw Refused{fmt::format("geometric_mean: {} is not above 0: leave such rows out", x)};
        }
        take(std::log(x));
    }
    [[nodiscard]] std::optional<double> value() const {
        double sum = 0.0;
        for (const double log : all()) {
            sum += log;
        }
        return all().empty() ? std::nullopt
                             : std::optional(std::exp(sum / static_cast<double>(all().size())));
    }
};

class StandardDeviation : public Rows {
public:
    void add(int /*count*/, sqlite3_value** values) { take(number("stddev_samp", values[0])); }
    [[nodiscard]] std::optional<double> value() const {
        double n = 0.0;
        double mean = 0.0;
        double squares = 0.0;
        for (const double x : all()) {
            n += 1.0;
            const double before = x - mean;
            mean += before / n;
            squares += before * (x - mean);
        }
        return n < 2.0 ? std::nullopt : std::optional(std::sqrt(squares / (n - 1.0)));
    }
};

class ShareOf {
public:
    void add(int /*count*/, sqlite3_value** values) {
        const double hit = number("share", values[0]);
        if (hit != 0.0 && hit != 1.0) {
            throw Refused{fmt::format("share: {} is neither 0 nor 1", hit)};
        }
        hits_ += hit;
        n_ += 1.0;
    }
    void remove(int /*count*/, sqlite3_value** values) {
        hits_ -= sqlite3_value_double(values[0]);
        n_ -= 1.0;
    }
    [[nodiscard]] std::optional<double> value() const {
        return n_ > 0.0 ? std::optional(hits_ / n_) : std::nullopt;
    }

private:
    double hits_ = 0.0;
    double n_ = 0.0;
};

/// An end of the interval over people; a row is a person.
template <bool Share, double Interval::*End>
class OverPeople : public Rows {
public:
    void add(int /*count*/, sqlite3_value** values) {
        const double x = number(kName, values[0]);
        if (Share ? !(x >= 0.0 && x <= 1.0) : !std::isfinite(x)) {
            throw Refused{fmt::format("{}: {} is no {}", kName, x,
                                      Share ? "share from 0 to 1" : "finite number")};
        }
        take(x);
    }
    [[nodiscard]] std::optional<double> value() const {
        if (all().empty()) {
            return std::nullopt;
        }
        const PeopleMean mean = Share ? mean_share_over_people(all()) : mean_over_people(all());
        return mean.interval ? std::optional((*mean.interval).*End) : std::nullopt;
    }

private:
    static constexpr const char* kName = Share ? "people_share" : "people_mean";
};

template <double Information::*Kind>
class Transmitted {
public:
    void add(int count, sqlite3_value** values) {
        ++rows_;
        counts_[{category(values[0]), category(values[1])}] += often(count, values);
    }
    void remove(int count, sqlite3_value** values) {
        --rows_;
        const auto cell = counts_.find({category(values[0]), category(values[1])});
        if (cell != counts_.end() && (cell->second -= often(count, values)) == 0) {
            counts_.erase(cell);
        }
    }
    [[nodiscard]] std::optional<double> value() const {
        return rows_ > 0 ? std::optional(mutual_information(counts_).*Kind) : std::nullopt;
    }

private:
    static std::int64_t often(int count, sqlite3_value** values) {
        const double n = count == 3 ? number("mutual_information", values[2]) : 1.0;
        if (!(n >= 0.0 && n < 1e15 && std::floor(n) == n)) {
            throw Refused{fmt::format(
                "mutual_information: n is {}: give how often, a whole number from 0", n)};
        }
        return static_cast<std::int64_t>(n);
    }
    /// The same for values that SQL takes for equal: 1 and 1.0, and neither is the text 1.
    static std::string category(sqlite3_value* value) {
        const int type = sqlite3_value_type(value);
        if (type == SQLITE_FLOAT) {
            const double number = sqlite3_value_double(value);
            const bool whole = std::fabs(number) < 0x1p63 && std::floor(number) == number;
            return whole ? fmt::format("n{}", static_cast<std::int64_t>(number))
                         : fmt::format("n{}", number);
        }
        const std::string mark = type == SQLITE_INTEGER ? "n" : type == SQLITE_TEXT ? "t" : "b";
        const auto* bytes = static_cast<const char*>(sqlite3_value_blob(value));
        const auto size = static_cast<std::size_t>(sqlite3_value_bytes(value));
        return bytes == nullptr ? mark : mark + std::string(bytes, size);
    }

    ConfusionCounts counts_;
    std::int64_t rows_ = 0;
};

/// SQLite keeps one pointer a group; the first row makes what it points to.
template <class Aggregate>
Aggregate** state(sqlite3_context* context, int bytes) {
    return static_cast<Aggregate**>(sqlite3_aggregate_context(context, bytes));
}

/// A row comes or, out of a window's frame, goes.
template <class Aggregate, bool comes>
void step(sqlite3_context* context, int count, sqlite3_value** values) {
    if (any_null(count, values)) {
        return;
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
        comes ? (*aggregate)->add(count, values) : (*aggregate)->remove(count, values);
    } catch (const Refused& refused) {
        sqlite3_result_error(context, refused.why.c_str(), static_cast<int>(refused.why.size()));
    } catch (const std::exception&) {
        sqlite3_result_error_nomem(context);
    }
}

template <class Aggregate>
void value(sqlite3_context* context) {
    auto** aggregate = state<Aggregate>(context, 0);
    if (aggregate == nullptr || *aggregate == nullptr) {
        return;
    }
    try {
        if (const auto result = (*aggregate)->value()) {
            sqlite3_result_double(context, *result);
        }
    } catch (const std::exception&) {
        sqlite3_result_error_nomem(context);
    }
}

template <class Aggregate>
void finish(sqlite3_context* context) {
    value<Aggregate>(context);
    if (auto** aggregate = state<Aggregate>(context, 0)) {
        delete *aggregate;
    }
}

template <class Aggregate>
int add(sqlite3* db, const char* name, int arguments) {
    return sqlite3_create_window_function(db, name, arguments,
                                          SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_INNOCUOUS,
                                          nullptr, step<Aggregate, true>, finish<Aggregate>,
                                          value<Aggregate>, step<Aggregate, false>, nullptr);
}

/// R's SQLite brings a median of its own, the same one. SQLite says busy there, since the statement
/// that loads this is running; then theirs stays.
int add_median(sqlite3* db) {
    const int code = add<Quantile>(db, "median", 1);
    return (code & 0xFF) == SQLITE_BUSY ? SQLITE_OK : code;
}

}  // namespace

int add_aggregate_functions(sqlite3* db) {
    using PlugIn = Transmitted<&Information::plug_in>;
    using MillerMadow = Transmitted<&Information::corrected>;
    const int codes[] = {
        add_median(db),
        add<Quantile>(db, "quantile", 2),
        add<GeometricMean>(db, "geometric_mean", 1),
        add<StandardDeviation>(db, "stddev_samp", 1),
        add<ShareOf>(db, "share", 1),
        add<OverPeople<true, &Interval::low>>(db, "people_share_low", 1),
        add<OverPeople<true, &Interval::high>>(db, "people_share_high", 1),
        add<OverPeople<false, &Interval::low>>(db, "people_mean_low", 1),
        add<OverPeople<false, &Interval::high>>(db, "people_mean_high", 1),
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
