#include "protocols/design/williams.hpp"

#include <algorithm>

namespace palpate::protocols {

std::vector<std::vector<std::size_t>> williams_rows(std::size_t n) {
    // 0, 1, n-1, 2, n-2, ...: its neighbours differ by every step 1 ... n-1 modulo n.
    std::vector<std::size_t> first;
    for (std::size_t place = 0; place < n; ++place) {
        first.push_back(place % 2 == 1 ? (place + 1) / 2 : (n - place / 2) % n);
    }
    std::vector<std::vector<std::size_t>> rows;
    for (std::size_t shift = 0; shift < n; ++shift) {
        std::vector<std::size_t> row;
        for (const std::size_t item : first) {
            row.push_back((item + shift) % n);
        }
        rows.push_back(std::move(row));
    }
    if (n % 2 == 1) {
        // An odd n balances the pairs only together with the mirror images.
        for (std::size_t i = 0; i < n; ++i) {
            std::vector<std::size_t> mirrored = rows[i];
            std::reverse(mirrored.begin(), mirrored.end());
            rows.push_back(std::move(mirrored));
        }
    }
    return rows;
}

}  // namespace palpate::protocols
