#pragma once

#include <cstddef>
#include <vector>

#include "engine/base/pcg32.hpp"

namespace palpate::protocols {

/// A first-order balanced sequence of k symbols 0 ... k - 1: k^2 + 1 places in which every ordered
/// pair stands side by side exactly once, a symbol after itself too. Carry-over from one trial to
/// the next is then the same for all conditions. The last symbol is the first; all others come k
/// times, it k + 1.
///
/// Such a sequence is an Eulerian circuit of the complete digraph with loops, opened at its first
/// symbol. It is drawn uniformly among all, by the proof of the BEST theorem (T. van
/// Aardenne-Ehrenfest and N. G. de Bruijn, 1951): the sequences that begin with r are one to one
/// with (a) a spanning tree of all symbols towards r and (b) for every symbol an order of its edges
/// out, in which the tree's edge comes last. Walking from r, and leaving each symbol by its next
/// unused edge, gives the sequence; the last exits make the tree. (a) is drawn by random walks with
/// their loops erased (D. B. Wilson, "Generating random spanning trees more quickly than the cover
/// time", 1996), here without weights, exactly uniform; (b) by shuffles; r uniformly, as each
/// begins equally many. Whole numbers only.
///
/// @param k  number of symbols; 0 gives no sequence
/// @throws std::invalid_argument above kMaxSymbols
[[nodiscard]] std::vector<std::size_t> eulerian_order(std::size_t k, Pcg32& random);

inline constexpr std::size_t kMaxSymbols = 1000;  ///< a million trials

}  // namespace palpate::protocols
