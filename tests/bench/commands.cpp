#include "tests/bench/commands.hpp"

#include "tests/bench/peers/peers.hpp"

namespace palpate::bench {

bool Words::flag(const std::string& name) {
    const auto found = std::find(words_.begin(), words_.end(), name);
    if (found == words_.end()) {
        return false;
    }
    peers_ = peers_ || name == "--peers";
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

double Words::number(const std::string& name, double otherwise, double min, double max) {
    const std::string text = value(name, fmt::format("{}", otherwise));
    double number = 0.0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, number);
    if (read.ec != std::errc() || read.ptr != end || !(number >= min && number <= max)) {
        throw WrongWord(fmt::format("{} is {}: give {} to {}", name, text, min, max));
    }
    return number;
}

void Words::finish() const {
    if (!words_.empty()) {
        throw WrongWord("\"" + words_.front() + "\" means nothing here");
    }
    if (peers_ && !have_peers()) {
        throw WrongWord(
            "this build has no peers: call it as ./palpate bench, which makes one, or configure "
            "with -DPALPATE_BENCH_PEERS=ON");
    }
}

Output::Output(std::string name, const char* head) : name_(std::move(name)) {
    if (!name_.empty()) {
        open(name_);
        if (!*this) {
            throw WrongWord("cannot write " + name_);
        }
        *this << head;
    }
}

void Output::finish() {
    if (is_open()) {
        close();
        if (!*this) {
            throw std::runtime_error("could not write all of " + name_);
        }
    }
}

}  // namespace palpate::bench
