import analysis as a

print(*a.main.friction.cat.categories, sep=' ', end='|')
print(*a.main.planned_object.cat.categories, sep=' ', end='|')
print(*a.trials.session_kind.cat.categories, sep=' ', end='|')
print(len(a.main), int(a.main.correct.sum()), sep='|')
