#include "protocols/order/order_counter.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <ranges>

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace palpate::protocols {
namespace {

/// The different levels of a factor, in order.
std::vector<std::size_t> levels_of(std::span<const Condition> trials,
                                   std::size_t Condition::*factor) {
    const auto counts = occurrences(trials, factor);
    const auto levels = std::views::keys(counts);
    return {levels.begin(), levels.end()};
}

std::size_t place_in(const std::vector<std::size_t>& levels, std::size_t level) {
    return static_cast<std::size_t>(std::ranges::lower_bound(levels, level) - levels.begin());
}

Natural choose(std::size_t n, std::size_t k) {
    return k > n ? Natural{} : multinomial({n - k, k});
}

/// Q(n, j) for j = 0 ... n; some are below 0.
std::vector<Natural> pieces_of(std::size_t n, std::size_t limit) {
    std::vector<Natural> ways(n + 1);
    if (n == 0) {
        ways[0] = 1;
    }
    for (std::size_t j = 1; j <= n; ++j) {
        for (std::size_t a = 0; a <= j && a * limit <= n - j; ++a) {
            const std::size_t rest = n - j - a * limit;
            if (rest % (limit + 1) == 0) {
                const std::size_t b = rest / (limit + 1);
                const Natural chosen = choose(j, a) * choose(j - 1 + b, b);
                ways[j] += a % 2 == 0 ? chosen : -chosen;
            }
        }
    }
    return ways;
}

/// Ways to mix s pieces of the levels so far with those of one more: C(s, j) for each.
std::vector<Natural> mixed(const std::vector<Natural>& before, const std::vector<Natural>& level) {
    std::vector<Natural> after(before.size() + level.size() - 1);
    std::vector<Natural> row{1};  // of Pascal's triangle
    for (std::size_t s = 0; s < after.size(); ++s) {
        for (std::size_t j = 0; j < level.size() && j <= s; ++j) {
            if (s - j < before.size()) {
                after[s] += before[s - j] * level[j] * row[j];
            }
        }
        row.emplace_back(1);
        for (std::size_t j = row.size() - 2; j > 0; --j) {
            row[j] += row[j - 1];
        }
    }
    return after;
}

}  // namespace

std::size_t bits_of(const Natural& n) {
    return n.is_zero() ? 0 : msb(n) + 1;
}

double share_of(const Natural& part, const Natural& whole) {
    using Wide = boost::multiprecision::cpp_bin_float_50;  // of any size
    return static_cast<double>(Wide(part) / Wide(whole));
}

Natural draw_below(const Natural& n, Pcg32& random) {
    constexpr std::size_t kWord = 32;  // bits of a random number
    const std::size_t bits = bits_of(n - 1);
    const std::size_t words = (bits + kWord - 1) / kWord;
    const std::size_t unused = words * kWord - bits;
    for (;;) {
        Natural drawn;
        for (std::size_t i = 0; i < words; ++i) {
            drawn <<= kWord;
            drawn |= i == 0 ? random.next() >> unused : random.next();
        }
        if (drawn < n) {
            return drawn;
        }
    }
}

Natural multinomial(const std::vector<std::size_t>& counts) {
    Natural orders = 1;
    std::size_t placed = 0;
    for (const std::size_t count : counts) {
        for (std::size_t i = 1; i <= count; ++i) {
            orders *= ++placed;
            orders /= i;  // C(placed, i) so far: never a rest
        }
    }
    return orders;
}

OrderCounter::OrderCounter(std::span<const Condition> trials, const RunLimits& limits)
    : object_names_(levels_of(trials, &Condition::object)),
      friction_names_(levels_of(trials, &Condition::friction)),
      limits_(limits) {
    objects_ = object_names_.size();
    frictions_ = friction_names_.size();
    start_.left.assign(objects_ * frictions_, 0);
    for (const Condition& condition : trials) {
        ++start_.left[place_in(object_names_, condition.object) * frictions_ +
                      place_in(friction_names_, condition.friction)];
    }
    start_.rest = trials.size();
}

std::optional<OrderCounter> OrderCounter::build(std::span<const Condition> trials,
                                                const RunLimits& limits,
                                                std::size_t max_states) {
    if (trials.size() > std::numeric_limits<std::uint16_t>::max()) {
        return std::nullopt;
    }
    OrderCounter counter(trials, limits);
    Place at = counter.start_;
    const Natural* total = counter.count(at, max_states);
    if (total == nullptr) {
        return std::nullopt;
    }
    counter.total_ = *total;
    return counter;
}

/// The last object's row first, the other rows sorted, then the runs as far as a limit asks for
/// them.
OrderCounter::Key OrderCounter::key_of(const Place& at) const {
    Key key;
    key.reserve(at.left.size() + 3);
    const auto row = [&](std::size_t object) {
        return std::span(at.left).subspan(object * frictions_, frictions_);
    };
    const bool object_bound = limits_.object > 0 && at.last.object_run > 0;
    if (object_bound) {
        key.append(row(at.last.object).begin(), row(at.last.object).end());
    }
    const std::size_t first = key.size();
    for (std::size_t object = 0; object < objects_; ++object) {
        if (object_bound && object == at.last.object) {
            continue;
        }
        std::size_t place = first;  // insertion sort: there are a handful of rows
        const auto one = row(object);
        while (place < key.size() &&
               !std::lexicographical_compare(
                   one.begin(), one.end(), key.begin() + static_cast<std::ptrdiff_t>(place),
                   key.begin() + static_cast<std::ptrdiff_t>(place + frictions_))) {
            place += frictions_;
        }
        key.insert(key.begin() + static_cast<std::ptrdiff_t>(place), one.begin(), one.end());
    }
    if (limits_.object > 0) {
        key.push_back(static_cast<char16_t>(at.last.object_run));
    }
    if (limits_.friction > 0) {
        key.push_back(static_cast<char16_t>(at.last.friction));
        key.push_back(static_cast<char16_t>(at.last.friction_run));
    }
    return key;
}

bool OrderCounter::step(Place& at, std::size_t object, std::size_t friction) const noexcept {
    const auto run = [](bool goes_on, std::uint16_t so_far) {
        return static_cast<std::uint16_t>(goes_on ? so_far + 1 : 1);
    };
    std::uint16_t& left = at.left[object * frictions_ + friction];
    const Last next{object, friction, run(object == at.last.object, at.last.object_run),
                    run(friction == at.last.friction, at.last.friction_run)};
    if (left == 0 || (limits_.object > 0 && next.object_run > limits_.object) ||
        (limits_.friction > 0 && next.friction_run > limits_.friction)) {
        return false;
    }
    --left;
    --at.rest;
    at.last = next;
    return true;
}

void OrderCounter::undo(Place& at, const Last& from) const noexcept {
    ++at.left[at.last.object * frictions_ + at.last.friction];
    ++at.rest;
    at.last = from;
}

const Natural* OrderCounter::count(Place& at, std::size_t max_states) {
    Key key = key_of(at);
    if (const auto known = ways_.find(key); known != ways_.end()) {
        return &known->second;
    }
    Natural sum = at.rest == 0 ? 1 : 0;
    const Last from = at.last;
    for (std::size_t object = 0; object < objects_; ++object) {
        for (std::size_t friction = 0; friction < frictions_; ++friction) {
            if (!step(at, object, friction)) {
                continue;
            }
            const Natural* after = count(at, max_states);
            undo(at, from);
            if (after == nullptr) {
                return nullptr;
            }
            sum += *after;
        }
    }
    if (ways_.size() >= max_states) {
        return nullptr;
    }
    return &ways_.emplace(std::move(key), std::move(sum)).first->second;
}

OrderWalk::OrderWalk(const OrderCounter& counter)
    : counter_(&counter), at_(counter.start_), ways_(&counter.total_) {}

Condition OrderWalk::next(Pcg32& random) {
    Natural drawn = draw_below(*ways_, random);
    const OrderCounter::Last from = at_.last;
    for (std::size_t object = 0; object < counter_->objects_; ++object) {
        for (std::size_t friction = 0; friction < counter_->frictions_; ++friction) {
            if (!counter_->step(at_, object, friction)) {
                continue;
            }
            const Natural& after = counter_->ways_.at(counter_->key_of(at_));
            if (drawn < after) {
                ways_ = &after;
                return {counter_->object_names_[object], counter_->friction_names_[friction]};
            }
            drawn -= after;
            counter_->undo(at_, from);
        }
    }
    return {};  // not reached: the ways add up
}

std::map<Condition, std::size_t> cells_of(std::span<const Condition> trials) {
    std::map<Condition, std::size_t> cells;
    for (const Condition& condition : trials) {
        ++cells[condition];
    }
    return cells;
}

Natural orders_of(std::span<const Condition> trials) {
    const auto cells = cells_of(trials);
    const auto counts = std::views::values(cells);
    return multinomial({counts.begin(), counts.end()});
}

std::vector<std::size_t> counts_of(std::span<const Condition> trials,
                                   std::size_t Condition::*factor) {
    const auto levels = occurrences(trials, factor);
    const auto counts = std::views::values(levels);
    return {counts.begin(), counts.end()};
}

bool binds(std::span<const std::size_t> counts, std::size_t limit) noexcept {
    return limit > 0 && std::ranges::any_of(counts, [&](std::size_t n) { return n > limit; });
}

Natural count_orders(std::span<const std::size_t> counts, std::size_t limit) {
    std::vector<Natural> pieces{1};
    for (const std::size_t count : counts) {
        pieces = mixed(pieces, pieces_of(count, limit));
    }
    return std::accumulate(pieces.begin(), pieces.end(), Natural{});
}

std::size_t rarity_of(std::span<const std::size_t> counts, std::size_t limit) {
    if (!binds(counts, limit)) {
        return 0;
    }
    const std::size_t trials = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
    if (trials <= kMaxCounted) {
        return bits_of(multinomial({counts.begin(), counts.end()})) -
               bits_of(count_orders(counts, limit));
    }
    const auto n = static_cast<double>(trials);
    double too_long = 0.0;
    for (const std::size_t count : counts) {
        const double share = static_cast<double>(count) / n;
        double runs = (n - static_cast<double>(limit)) * (1.0 - share);
        for (std::size_t i = 0; i <= limit && runs > 0x1p-40; ++i) {
            runs *= share;
        }
        too_long += runs;
    }
    constexpr double kBitsPerRun = 1.4427;  // 1 / ln 2: exp(-too_long) have none
    return static_cast<std::size_t>(too_long * kBitsPerRun);
}

}  // namespace palpate::protocols
