#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {
namespace {

template <int D>
void append(Methods<D>& all, Methods<D> more) {
    std::move(more.begin(), more.end(), std::back_inserter(all));
}

}  // namespace

bool have_peers() noexcept {
    return true;
}

Methods<2> peer_methods(const Object& object) {
    Methods<2> methods;
    append(methods, sisl_methods(object));
    append(methods, occt_methods(object));
    append(methods, cgal_methods(object));
    return methods;
}

Methods<3> peer_surface_methods(const Surface& surface) {
    Methods<3> methods;
    append(methods, sisl_surface_methods(surface));
    append(methods, occt_surface_methods(surface));
    append(methods, cgal_surface_methods(surface));
    return methods;
}

}  // namespace palpate::bench
