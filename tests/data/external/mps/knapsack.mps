NAME knapsack
ROWS
 N cost
 G enough
COLUMNS
 M1 'MARKER' 'INTORG'
 x cost 2 enough 2
 y cost 3 enough 3
 M2 'MARKER' 'INTEND'
RHS
 RHS enough 4
BOUNDS
 UP BND x 4
 UP BND y 1
ENDATA
