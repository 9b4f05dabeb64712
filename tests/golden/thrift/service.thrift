service A extends Bass { void f() }
service Base extends Base {}
