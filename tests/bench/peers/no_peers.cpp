#include "tests/bench/data/trace_store.hpp"
#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {

bool have_peers() noexcept {
    return false;
}
Methods<2> peer_methods(const Object& /*object*/) {
    return {};
}
Methods<2> sisl_methods(const Object& /*object*/) {
    return {};
}
Methods<2> occt_methods(const Object& /*object*/) {
    return {};
}
Methods<3> peer_surface_methods(const Surface& /*surface*/) {
    return {};
}

std::unique_ptr<TraceStore> hdf5_store(const std::string& /*folder*/) {
    return nullptr;
}

}  // namespace palpate::bench
