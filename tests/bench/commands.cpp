#include "tests/bench/commands.hpp"

#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {

bool Words::flag(const std::string& name) {
    const auto found = std::find(words_.begin(), words_.end(), name);
    if (found == words_.end()) {
        return false;
    }
    words_.erase(found);
    return true;
}

std::string Words::value(const std::string& name, const std::string& otherwise) {
    const auto found = std::find(words_.begin(), words_.end(), name);
    if (found == words_.end()) {
        return otherwise;
    }
    if (found + 1 == words_.end() || (found + 1)->rfind("--", 0) == 0) {
        throw WrongWord(name + " needs a value after it");
    }
    const std::string value = *(found + 1);
    words_.erase(found, found + 2);
    return value;
}

void Words::finish(const std::string& usage) const {
    if (!words_.empty()) {
        throw WrongWord("\"" + words_.front() + "\" means nothing here: " + usage);
    }
}

void need_peers_if(bool wanted) {
    if (wanted && !have_peers()) {
        throw WrongWord(
            "this build has no peers: call it as ./palpate bench, which makes one, or configure "
            "with -DPALPATE_BENCH_PEERS=ON");
    }
}

std::ofstream open_output(const std::string& name) {
    std::ofstream out;
    if (!name.empty()) {
        out.open(name);
        if (!out) {
            throw WrongWord("cannot write " + name);
        }
    }
    return out;
}

void close_output(std::ofstream& out, const std::string& name) {
    out.close();
    if (!out) {
        throw std::runtime_error("could not write all of " + name);
    }
}

}  // namespace palpate::bench
