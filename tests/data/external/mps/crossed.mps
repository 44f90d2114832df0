NAME crossed
ROWS
 N cost
 G least
 L most
COLUMNS
 x cost 1 least 1
 x most 1
 y least 1 most 1
RHS
 RHS least 2 most 1
ENDATA
