#include "protocols/order/eulerian_order.hpp"

#include <numeric>
#include <span>

#include "engine/base/refuse.hpp"

namespace palpate::protocols {
namespace {

/// exit[v] for v != root: the next symbol on the way to the root. Uniform over all k^(k-2) trees.
std::vector<std::size_t> spanning_tree(std::size_t k, std::size_t root, Pcg32& random) {
    std::vector<std::size_t> exit(k, root);
    std::vector<bool> in_tree(k, false);
    in_tree[root] = true;
    for (std::size_t start = 0; start < k; ++start) {
        // The last exit taken from a symbol overwrites those of the loops before it.
        for (std::size_t at = start; !in_tree[at]; at = exit[at]) {
            exit[at] = random.bounded(static_cast<std::uint32_t>(k));
        }
        for (std::size_t at = start; !in_tree[at]; at = exit[at]) {
            in_tree[at] = true;
        }
    }
    return exit;
}

/// All symbols in random order, `last` at the end.
std::vector<std::size_t> exits(std::size_t k, std::size_t last, Pcg32& random) {
    std::vector<std::size_t> order(k);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::swap(order[last], order[k - 1]);
    shuffle(std::span(order).first(k - 1), random);
    return order;
}

}  // namespace

std::vector<std::size_t> eulerian_order(std::size_t k, Pcg32& random) {
    refuse_if(k > kMaxSymbols,
              "a first-order balanced sequence of {} symbols has {} trials: use at most {} symbols",
              k, k * k + 1, kMaxSymbols);
    if (k == 0) {
        return {};
    }
    const auto symbols = static_cast<std::uint32_t>(k);
    const std::size_t root = random.bounded(symbols);
    const std::vector<std::size_t> tree = spanning_tree(k, root, random);
    std::vector<std::vector<std::size_t>> out;
    for (std::size_t symbol = 0; symbol < k; ++symbol) {
        // The root's last exit is any: the circuit ends there.
        out.push_back(exits(k, symbol == root ? random.bounded(symbols) : tree[symbol], random));
    }
    std::vector<std::size_t> used(k, 0);
    std::vector<std::size_t> order{root};
    while (used[order.back()] < k) {
        const std::size_t at = order.back();
        order.push_back(out[at][used[at]++]);
    }
    return order;
}

}  // namespace palpate::protocols
