import sqlite3, sys
db = sqlite3.connect(sys.argv[1])
db.enable_load_extension(True)
db.load_extension(sys.argv[2])
for row in db.execute(sys.argv[3]):
    print(*('' if v is None else v for v in row), sep=',')
