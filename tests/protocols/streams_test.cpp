#include "engine/base/sha256.hpp"
#include "protocols/design/streams.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::protocols;

// FIPS 180-4 and its example values (NIST, "Examples with intermediate values": SHA-256).
TEST_CASE("SHA-256 gives the published digests", "[hash]") {
    CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
          "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256_hex(std::string(1000000, 'a')) ==
          "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_CASE("a stream is the hash of its key's text", "[random]") {
    const StreamKey key{.protocol_hash = "abcd",
                        .participant = "p01",
                        .session = 2,
                        .block = 3,
                        .purpose = "order.main",
                        .seed = 42};
    const std::string text =
        "palpate-stream-v1\nprotocol=4:abcd\nparticipant=3:p01\nsession=2\nblock=3\n"
        "purpose=10:order.main\nseed=42\n";
    CHECK(canonical_text(key) == text);

    const std::string hex = sha256_hex(text);
    const Pcg32 expected(std::stoull(hex.substr(0, 16), nullptr, 16),
                         std::stoull(hex.substr(16, 16), nullptr, 16));
    CHECK(stream(key) == expected);
}

TEST_CASE("keys that differ anywhere have different texts and streams", "[random][law]") {
    const StreamKey key{.protocol_hash = "h", .participant = "p", .purpose = "catch"};
    std::vector<StreamKey> keys(8, key);
    keys[1].protocol_hash = std::string("i");
    keys[2].participant = std::string("q");
    keys[3].session = 2;
    keys[4].block = 1;
    keys[5].purpose = std::string("hand");
    keys[6].seed = 1;
    // A participant whose name imitates the rest of the text.
    keys[7].participant = std::string("p\nsession=1\nblock=0\npurpose=5:catch\nseed=0");
    std::set<std::string> texts;
    std::set<std::uint64_t> first;
    for (const StreamKey& one : keys) {
        texts.insert(canonical_text(one));
        Pcg32 random = stream(one);
        const std::uint64_t upper = random.next();
        first.insert((upper << 32U) | random.next());
    }
    CHECK(texts.size() == keys.size());
    CHECK(first.size() == keys.size());
}
