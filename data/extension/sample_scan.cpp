#include "data/extension/sample_scan.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <string_view>

#include <sqlite3ext.h>

SQLITE_EXTENSION_INIT3

namespace palpate::data {
namespace {

/// One letter for each value given to filter(), in order.
char letter(int column, unsigned char op) {
    const bool equal = op == SQLITE_INDEX_CONSTRAINT_EQ || op == SQLITE_INDEX_CONSTRAINT_IS;
    const bool above = op == SQLITE_INDEX_CONSTRAINT_GT || op == SQLITE_INDEX_CONSTRAINT_GE;
    const bool below = op == SQLITE_INDEX_CONSTRAINT_LT || op == SQLITE_INDEX_CONSTRAINT_LE;
    const bool beyond = op == SQLITE_INDEX_CONSTRAINT_GT || op == SQLITE_INDEX_CONSTRAINT_LT;
    switch (static_cast<SampleColumn>(column)) {
        case SampleColumn::trial_id:
            return equal ? 'T' : above ? (beyond ? 'G' : 'g') : below ? (beyond ? 'L' : 'l') : '\0';
        case SampleColumn::interval:
            return equal ? 'I' : '\0';
        case SampleColumn::tick:
            return equal ? 'k' : above ? 'a' : below ? 'b' : '\0';
        case SampleColumn::time_s:
            return equal ? 's' : above ? 'f' : below ? 't' : '\0';
        default:
            return '\0';
    }
}

/// How the rows come by themselves: trial_id, interval, tick or time_s; or the trial's intervals
/// merged.
/// @return '\0' if they do not, else 'n', or 'm' (by time) or 'M' (by tick) for merged
char order_of(const sqlite3_index_info& info, const std::string& letters) {
    const bool one_trial = letters.find('T') != std::string::npos;
    const bool one_interval = letters.find('I') != std::string::npos;
    int next = one_trial ? 1 : 0;  // how many of trial_id, interval, tick are in order so far
    bool merged = false;
    char by = 'n';
    for (int i = 0; i < info.nOrderBy; ++i) {
        const auto column = static_cast<SampleColumn>(info.aOrderBy[i].iColumn);
        if (info.aOrderBy[i].desc != 0 || next > 2) {
            return '\0';
        }
        if (column == SampleColumn::trial_id && (next == 0 || one_trial)) {
            next = std::max(next, 1);
        } else if (column == SampleColumn::interval && !merged && (next == 1 || one_interval)) {
            next = std::max(next, next == 0 ? 0 : 2);
        } else if ((column == SampleColumn::time_s || column == SampleColumn::tick) && next >= 1) {
            merged = next == 1 && !one_interval;
            by = !merged ? 'n' : column == SampleColumn::time_s ? 'm' : 'M';
            next = 3;
        } else {
            return '\0';
        }
    }
    return by;
}

/// A trial by its id is found in an index. All trials are dear, so that a join asks for one trial
/// after the other: as many trials as SQLite takes a table to have rows of which it knows nothing.
void estimate(sqlite3_index_info& info, const std::string& letters) {
    constexpr double kTicks = 3e4;  // 30 s at 1 kHz
    constexpr double kTrials = 1048576.0;
    const auto has = [&letters](std::string_view any) {
        return letters.find_first_of(any) != std::string::npos;
    };
    const double ticks = has("k") ? 1.0 : has("abfts") ? 0.25 * kTicks : kTicks;
    const double trials = has("T") ? 1.0 : has("gGlL") ? 0.25 * kTrials : kTrials;
    info.estimatedRows = static_cast<sqlite3_int64>(trials * ticks);
    info.estimatedCost = has("T") ? 100.0 + ticks : 1e3 * trials * kTicks;
}

/// The whole number that an INTEGER column could equal; none for NULL, text, fractions.
std::optional<std::int64_t> equal_to(sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (type == SQLITE_INTEGER) {
        return sqlite3_value_int64(value);
    }
    const double real = sqlite3_value_double(value);
    constexpr double kWhole = 9e15;
    if (type == SQLITE_FLOAT && std::fabs(real) < kWhole && std::floor(real) == real) {
        return static_cast<std::int64_t>(real);
    }
    return std::nullopt;
}

/// The lowest whole number >= bound, or > bound.
std::int64_t lowest(double bound, bool beyond) noexcept {
    constexpr double kWhole = 9e15;
    const double whole = beyond ? std::floor(bound) + 1.0 : std::ceil(bound);
    return whole < -kWhole ? INT64_MIN
         : whole > kWhole  ? INT64_MAX
                           : static_cast<std::int64_t>(whole);
}
std::int64_t highest(double bound, bool beyond) noexcept {
    const std::int64_t low = lowest(-bound, beyond);
    return low == INT64_MIN ? INT64_MAX : -low;
}

/// Narrows the scan by one constraint. Bounds of ticks and times are widened to inclusive ones:
/// SQLite looks again. Not those of trials: one that nobody asks for may be damaged.
void narrow(SampleScan& scan, char one, sqlite3_value* value) {
    const int type = sqlite3_value_numeric_type(value);
    if (one == 'T' || one == 'I') {
        const auto only = equal_to(value);
        scan.nothing = scan.nothing || !only;
        if (only && one == 'T') {
            scan.trials = {std::max(scan.trials.first, *only), std::min(scan.trials.last, *only)};
        } else if (only) {
            scan.interval = only;
        }
        return;
    }
    if (type == SQLITE_NULL) {
        scan.nothing = true;
        return;
    }
    if (type != SQLITE_INTEGER && type != SQLITE_FLOAT) {
        return;  // texts are above all numbers: SQLite sees to it
    }
    const double bound = sqlite3_value_double(value);
    TickRange& range = scan.range;
    if (one == 's' || one == 'f') {
        range.from_s = std::max(range.from_s, bound);
    }
    if (one == 's' || one == 't') {
        range.to_s = std::min(range.to_s, bound);
    }
    if (one == 'k' || one == 'a') {
        range.first = std::max(range.first, lowest(bound, false));
    }
    if (one == 'k' || one == 'b') {
        range.last = std::min(range.last, highest(bound, false));
    }
    if (one == 'g' || one == 'G') {
        scan.trials.first = std::max(scan.trials.first, lowest(bound, one == 'G'));
    }
    if (one == 'l' || one == 'L') {
        scan.trials.last = std::min(scan.trials.last, highest(bound, one == 'L'));
    }
}

}  // namespace

void choose_scan(sqlite3_index_info& info) {
    std::string letters;
    for (int i = 0; i < info.nConstraint; ++i) {
        const auto& constraint = info.aConstraint[i];
        const char one = letter(constraint.iColumn, constraint.op);
        const bool exact = one == 'T' || one == 'I';
        if (constraint.usable == 0 || one == '\0' ||
            (exact && letters.find(one) != std::string::npos)) {
            continue;
        }
        letters += one;
        info.aConstraintUsage[i].argvIndex = static_cast<int>(letters.size());
        // filter() compares trial and interval as SQLite does; ranges are looked at again.
        info.aConstraintUsage[i].omit = exact ? 1 : 0;
    }
    const char order = order_of(info, letters);
    info.orderByConsumed = info.nOrderBy > 0 && order != '\0' ? 1 : 0;
    estimate(info, letters);
    info.idxStr = sqlite3_mprintf("%llx %c%s", static_cast<unsigned long long>(info.colUsed),
                                  info.orderByConsumed != 0 ? order : 'n', letters.c_str());
    info.needToFreeIdxStr = 1;
    if (info.idxStr == nullptr) {
        throw std::bad_alloc();
    }
}

SampleScan chosen_scan(std::string_view plan, std::span<sqlite3_value* const> values) {
    SampleScan scan;
    const std::string words(plan);
    std::size_t end = 0;
    scan.columns = std::stoull(words, &end, 16);
    const char order = words.at(end + 1);
    scan.by_time = order == 'm';
    scan.by_tick = order == 'M';
    for (std::size_t i = 0; i < values.size(); ++i) {
        narrow(scan, words.at(end + 2 + i), values[i]);
    }
    return scan;
}

}  // namespace palpate::data
