#include "tests/support/disk_model.hpp"

#include "tests/support/slurp.hpp"

namespace palpate::tests {
namespace {

void give(std::map<std::string, int>& names, const DiskCall& change) {
    names.erase(change.gone);
    if (change.child < 0) {
        names.erase(change.text);
    } else {
        names[change.text] = change.child;
    }
}

/// How many of `calls` came through.
std::size_t how_many(Leaves leaves, std::size_t calls, Random& random) {
    switch (leaves) {
        case Leaves::nothing:
            return 0;
        case Leaves::everything:
            return calls;
        case Leaves::some_calls:
            return random.index(calls + 1);
        case Leaves::sectors_512:
        case Leaves::sectors_4k:
            break;
    }
    const int third = random.below(3);
    return third == 0 ? 0 : third == 1 ? calls : random.index(calls + 1);
}

}  // namespace

DiskModel::DiskModel(const std::filesystem::path& folder) : nodes_(1) {
    load(0, folder);
}

void DiskModel::load(int node, const std::filesystem::path& folder) {
    nodes_[static_cast<std::size_t>(node)].folder = true;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const int child = size();
        nodes_.emplace_back();
        nodes_[static_cast<std::size_t>(node)].names[entry.path().filename().string()] = child;
        if (entry.is_directory()) {
            load(child, entry.path());
        } else {
            const std::string bytes = slurp(entry.path());
            nodes_.back().bytes.assign(bytes.begin(), bytes.end());
        }
    }
}

std::map<std::string, int> DiskModel::paths() const {
    std::map<std::string, int> all;
    list(0, "", all);
    return all;
}

void DiskModel::list(int node, const std::string& prefix, std::map<std::string, int>& all) const {
    all[prefix] = node;
    for (const auto& [name, child] : nodes_[static_cast<std::size_t>(node)].names) {
        list(child, prefix.empty() ? name : prefix + '/' + name, all);
    }
}

void DiskModel::apply(const DiskCall& call) {
    if (call.kind == DiskCall::Kind::make_file || call.kind == DiskCall::Kind::make_folder) {
        nodes_.push_back({.folder = call.kind == DiskCall::Kind::make_folder});
        return;
    }
    Node& node = nodes_.at(static_cast<std::size_t>(call.node));
    switch (call.kind) {
        case DiskCall::Kind::write:
            node.since.push_back({.at = call.at, .bytes = call.text});
            break;
        case DiskCall::Kind::resize:
            node.since.push_back({.resize = true, .at = call.at});
            break;
        case DiskCall::Kind::name:
            node.names_since.push_back(call);
            break;
        default:
            for (const Change& change : node.since) {
                play(node.bytes, change);
            }
            for (const DiskCall& change : node.names_since) {
                give(node.names, change);
            }
            node.since.clear();
            node.names_since.clear();
    }
}

void DiskModel::play(std::string& bytes, const Change& change) {
    const auto at = static_cast<std::size_t>(change.at);
    if (change.resize) {
        bytes.resize(at, '\0');
        return;
    }
    bytes.resize(std::max(bytes.size(), at + change.bytes.size()), '\0');
    bytes.replace(at, change.bytes.size(), change.bytes);
}

std::string DiskModel::bytes_left(const Node& node, Leaves leaves, Random& random) {
    // What the file would be after each number of calls, sector by sector.
    const std::size_t sector = leaves == Leaves::sectors_512 ? 512 : 4096;
    const bool torn = leaves == Leaves::sectors_512 || leaves == Leaves::sectors_4k;
    const std::size_t calls = node.since.size();
    const std::size_t for_size = how_many(leaves, calls, random);
    // Nothing of before a cut to a shorter size is there after it, nor the other way round.
    std::size_t first = 0;
    std::size_t last = calls;
    for (std::size_t i = 0; i < calls; ++i) {
        if (node.since[i].resize && i < for_size) {
            first = i + 1;
        } else if (node.since[i].resize && last == calls) {
            last = i;
        }
    }
    std::string now = node.bytes;
    std::string left;
    std::size_t size = now.size();
    std::vector<std::size_t> when;  // of each sector
    for (std::size_t i = 0;; ++i) {
        for (std::size_t s = when.size(); s * sector < now.size(); ++s) {
            when.push_back(torn ? first + how_many(leaves, last - first, random) : for_size);
            left.resize(std::max(left.size(), now.size()), '\0');
        }
        for (std::size_t s = 0; s < when.size() && s * sector < now.size(); ++s) {
            if (when[s] == i) {
                left.replace(s * sector, sector, now, s * sector, sector);
            }
        }
        size = for_size == i ? now.size() : size;
        if (i == calls) {
            break;
        }
        play(now, node.since[i]);
    }
    left.resize(size, '\0');
    return left;
}

std::map<std::string, int> DiskModel::names_left(const Node& node, Leaves leaves, Random& random) {
    const bool torn = leaves == Leaves::sectors_512 || leaves == Leaves::sectors_4k;
    const std::size_t first = how_many(leaves, node.names_since.size(), random);
    std::map<std::string, int> names = node.names;
    for (std::size_t i = 0; i < node.names_since.size(); ++i) {
        if (torn ? random.coin() : i < first) {
            give(names, node.names_since[i]);
        }
    }
    return names;
}

void DiskModel::lay_out(Leaves leaves, Random& random, const std::filesystem::path& into) const {
    lay_out(0, leaves, random, into);
}

void DiskModel::lay_out(int number,
                        Leaves leaves,
                        Random& random,
                        const std::filesystem::path& into) const {
    for (const auto& [name, child] :
         names_left(nodes_[static_cast<std::size_t>(number)], leaves, random)) {
        const Node& node = nodes_.at(static_cast<std::size_t>(child));
        if (node.folder) {
            std::filesystem::create_directory(into / name);
            lay_out(child, leaves, random, into / name);
            continue;
        }
        std::string bytes = bytes_left(node, leaves, random);
        if (name.ends_with("-shm")) {
            if (random.coin()) {
                continue;
            }
            std::ranges::generate(bytes, [&] { return static_cast<char>(random.below(256)); });
        }
        std::ofstream(into / name, std::ios::binary)
            .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
}

}  // namespace palpate::tests
