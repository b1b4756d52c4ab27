# C++: how files hang on one another. Input: the paths of all files of the product from the tree's top, a line each.
# Breaches: a header on which a chain of more than `longest` headers hangs, itself counted; and files that need one
# another in a ring, a header and the source beside it being one: none of them can be read or tested alone.
# With -v measure=1 it says both numbers as well.
# Portable awk (mawk too).

BEGIN { longest = 12 }

{
    seen[$0] = 1
    for (number = 1; (getline text <$0) > 0; number++)
        if (text ~ /^[ \t]*#[ \t]*include[ \t]*"/) {
            sub(/^[^"]*"/, "", text)
            sub(/".*/, "", text)
            of[$0, ++count[$0]] = text
            line[$0, text] = number
        }
    close($0)
}

# Of headers that a file needs, itself counted: the longest way down.
function depth(file,   i, to) {
    if (file in deep) return deep[file]
    deep[file] = 1  # a ring of headers alone ends here
    for (i = 1; i <= count[file]; i++) {
        to = of[file, i]
        if (to in seen && depth(to) + 1 > deep[file]) {
            deep[file] = deep[to] + 1
            next_of[file] = to
        }
    }
    return deep[file]
}

function chain(file,   text) {
    for (text = file; file in next_of; text = text " > " file) file = next_of[file]
    return text
}

function unit(path) {
    sub(/\.[hc]pp$/, "", path)
    return path
}

# The rings on which a unit is: R. E. Tarjan, SIAM J. Comput. 1:146, 1972.
function walk(at,   i, to, ring, size, last, first) {
    place[at] = low[at] = ++places
    stack[++height] = at
    on[at] = 1
    for (i = 1; i <= edges[at]; i++) {
        to = edge[at, i]
        if (!(to in place)) {
            walk(to)
            if (low[to] < low[at]) low[at] = low[to]
        } else if (on[to] && place[to] < low[at]) low[at] = place[to]
    }
    if (low[at] != place[at]) return
    first = at
    do {
        last = stack[height--]
        on[last] = 0
        ring = ring " " last
        size++
        if (last < first) first = last
    } while (last != at)
    if (size == 1) return
    rings++
    print first (first ".hpp" in seen ? ".hpp" : ".cpp") ":1: a ring of files, none of which can stand alone:" ring
}

END {
    for (file in seen) {
        units[unit(file)] = 1
        for (i = 1; i <= count[file]; i++)
            if (of[file, i] in seen && unit(of[file, i]) != unit(file))
                edge[unit(file), ++edges[unit(file)]] = unit(of[file, i])
        if (file !~ /\.hpp$/) continue
        if (depth(file) > max) max = depth(file)
        if (depth(file) > longest)
            print file ":" line[file, next_of[file]] ": a chain of " depth(file) " headers hangs on it, " longest \
                " at most: forward-declare, or part one; " chain(file)
    }
    for (at in units) if (!(at in place)) walk(at)
    if (measure) print "longest chain of headers: " max + 0 ", rings of files: " rings + 0
}
