#include "tests/figures/region_map.hpp"

namespace palpate::figures {
namespace {

using engine::Vec2;

/// Where the region changes on the way from `a` to `b`, and the regions on both sides of that
/// place.
struct Change {
    Vec2 at{};
    int before = 0;
    int after = 0;
};

/// @pre the regions of a and b differ
Change change(const RegionMap& map, Vec2 a, Vec2 b) {
    constexpr double kNear = 1e-12;  // m
    Change found{.at = {}, .before = map.at(a), .after = map.at(b)};
    while (glm::length(b - a) > kNear) {
        const Vec2 middle = 0.5 * (a + b);
        const int region = map.at(middle);
        if (region == found.before) {
            a = middle;
        } else {
            b = middle;
            found.after = region;
        }
    }
    found.at = 0.5 * (a + b);
    return found;
}

struct Crossing {
    Vec2 at{};
    int region = 0;
    int other = 0;
};

/// The true vertex of the outline in or beside the cell whose lower corner is `low`, if there is
/// one.
std::optional<Vec2> vertex_near(const RegionMap& map, const Vec2& low, double step) {
    for (const engine::Seam& seam : map.outline().seams()) {
        const Vec2 p = seam.point - low;
        if (seam.kind != engine::SeamKind::smooth && p.x >= -step && p.y >= -step &&
            p.x <= 2.0 * step && p.y <= 2.0 * step) {
            return seam.point;
        }
    }
    return std::nullopt;
}

void add_cell(const RegionMap& map,
              const Lattice& lattice,
              const std::array<Vec2, 4>& corner,
              const std::array<int, 4>& region,
              std::vector<Border>& out) {
    std::vector<Crossing> found;
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        if (region[k] == region[next] || map.external(region[k]) != map.external(region[next])) {
            continue;
        }
        const auto add = [&](const Change& c) {
            if (map.external(c.before) == map.external(c.after)) {
                found.push_back({c.at, std::min(c.before, c.after), std::max(c.before, c.after)});
            }
        };
        const Change first = change(map, corner[k], corner[next]);
        add(first);
        if (first.after != region[next]) {  // a narrow region lies between
            add(change(map, corner[next], corner[k]));
        }
    }
    // Two crossings of one border are a piece of it; a lone one ends at a vertex or where regions
    // meet.
    std::vector<Crossing> lone;
    while (!found.empty()) {
        const Crossing one = found.back();
        found.pop_back();
        const auto partner = std::find_if(found.begin(), found.end(), [&](const Crossing& c) {
            return c.region == one.region && c.other == one.other;
        });
        if (partner == found.end()) {
            lone.push_back(one);
        } else {
            out.push_back({one.at, partner->at, one.region, one.other});
            found.erase(partner);
        }
    }
    const auto vertex = vertex_near(map, corner[0], lattice.step);
    if (lone.empty() || (lone.size() < 2 && !vertex)) {
        return;
    }
    Vec2 middle{};
    for (const Crossing& c : lone) {
        middle += c.at / static_cast<double>(lone.size());
    }
    for (const Crossing& c : lone) {
        out.push_back({vertex.value_or(middle), c.at, c.region, c.other});
    }
}

}  // namespace

RegionMap::RegionMap(const std::vector<engine::NurbsCurve<2>>& curves)
    : curves_(static_cast<int>(curves.size())), outline_(curves, true), feet_(outline_) {}

int RegionMap::at(const Vec2& h) const {
    const engine::ClosestPoint cp = feet_.closest(h);
    const engine::Seam* seam = cp.place.on_seam ? &outline_.seams()[cp.place.index] : nullptr;
    const std::size_t span = seam != nullptr ? seam->before : cp.place.index;
    const int segment = static_cast<int>(outline_.name(span).segment);
    if (cp.inside) {
        return 2 * curves_ + segment;
    }
    const bool vertex = seam != nullptr && seam->kind != engine::SeamKind::smooth;
    return 2 * segment + (vertex ? 1 : 0);
}

std::string RegionMap::name(int region) const {
    return external(region) ? std::string(1, static_cast<char>('a' + region))
                            : std::string(1, static_cast<char>('1' + region - 2 * curves_));
}

std::vector<int> regions_of(const RegionMap& map, const Lattice& lattice) {
    std::vector<int> regions;
    for (int row = 0; row < lattice.rows; ++row) {
        for (int column = 0; column < lattice.columns; ++column) {
            regions.push_back(map.at(lattice.node(column, row)));
        }
    }
    return regions;
}

std::vector<Border> borders(const RegionMap& map, const Lattice& lattice) {
    const std::vector<int> regions = regions_of(map, lattice);
    const auto at = [&](int column, int row) {
        return regions[static_cast<std::size_t>(row * lattice.columns + column)];
    };
    std::vector<Border> out;
    for (int row = 0; row + 1 < lattice.rows; ++row) {
        for (int column = 0; column + 1 < lattice.columns; ++column) {
            add_cell(map, lattice,
                     {lattice.node(column, row), lattice.node(column + 1, row),
                      lattice.node(column + 1, row + 1), lattice.node(column, row + 1)},
                     {at(column, row), at(column + 1, row), at(column + 1, row + 1),
                      at(column, row + 1)},
                     out);
        }
    }
    return out;
}

std::vector<std::array<int, 2>> neighbours(const RegionMap& map, const Lattice& lattice) {
    const std::vector<int> regions = regions_of(map, lattice);
    const auto at = [&](int column, int row) {
        return regions[static_cast<std::size_t>(row * lattice.columns + column)];
    };
    std::set<std::array<int, 2>> pairs;
    const auto add = [&](int column, int row, int next_column, int next_row) {
        if (next_column < lattice.columns && next_row < lattice.rows &&
            at(column, row) != at(next_column, next_row)) {
            const Change found =
                change(map, lattice.node(column, row), lattice.node(next_column, next_row));
            pairs.insert(
                {std::min(found.before, found.after), std::max(found.before, found.after)});
        }
    };
    for (int row = 0; row < lattice.rows; ++row) {
        for (int column = 0; column < lattice.columns; ++column) {
            add(column, row, column + 1, row);
            add(column, row, column, row + 1);
        }
    }
    return {pairs.begin(), pairs.end()};
}

}  // namespace palpate::figures
