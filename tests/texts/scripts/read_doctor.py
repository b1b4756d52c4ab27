import json, sys
report = json.load(open(sys.argv[1]))
assert report["palpate"], report
checks = report["checks"]
names = [c["name"] for c in checks]
for name in ["device", "kinematics", "clock", "kernel", "scheduling", "memory", "processor sleep",
             "timer slack", "jitter", "cyclictest", "host", "display", "audio", "font", "disk"]:
    assert names.count(name) == 1, (name, names)
for c in checks:
    assert set(c) == {"name", "status", "detail", "remedy", "numbers"}, c
    assert c["status"] in ("ok", "warn", "fail"), c
    assert c["detail"], c
    assert c["status"] == "ok" or c["remedy"], c
    assert all(isinstance(v, (int, float)) for v in c["numbers"].values()), c
print(sum(c["status"] == "fail" for c in checks))
