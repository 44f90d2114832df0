NAME endless
ROWS
 N cost
 G least
COLUMNS
 x cost -1 least 1
RHS
 RHS least 1
ENDATA
