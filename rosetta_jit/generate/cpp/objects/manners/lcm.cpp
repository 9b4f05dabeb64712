/* lcm-gen's classes: a message that has a type which contains itself, in lists alone, has it as a member. */

/* == link is there == */
true

/* == link clear == */
$at = {};

/* == link make == */

/* == link value == */
$at
