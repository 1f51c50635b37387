" Vim syntax file: Rhai, with the functions of droptower.
if exists("b:current_syntax")
  finish
endif

syntax keyword rhaiConditional if else switch
syntax keyword rhaiRepeat while loop do until for in
syntax keyword rhaiStatement continue break return
syntax keyword rhaiException throw try catch
syntax keyword rhaiInclude import export as
syntax keyword rhaiDeclaration let const fn private global
syntax keyword rhaiBoolean true false
syntax keyword rhaiThis this
syntax match rhaiNumber "\<\d[0-9_]*\%(\.\d[0-9_]*\)\=\%([eE][+-]\=\d\+\)\=\>"
syntax match rhaiNumber "\<0[xX][0-9A-Fa-f_]\+\>\|\<0[oO][0-7_]\+\>\|\<0[bB][01_]\+\>"
syntax match rhaiFunction "\%(\<fn\s\+\)\@<=\h\w*"

syntax match rhaiEscape contained +\\\%(x\x\{2}\|u\x\{4}\|U\x\{8}\|[\\"ntr]\)\|""+
syntax region rhaiString matchgroup=rhaiString start=+"+ skip=+\\\\\|\\"+ end=+"+ contains=rhaiEscape
syntax match rhaiCharacter +'\%(\\.[^']*\|[^'\\]\)'+
syntax region rhaiTemplate matchgroup=rhaiTemplate start=+`+ skip=+``+ end=+`+ contains=rhaiInterpolation
syntax region rhaiInterpolation contained matchgroup=rhaiDelimiter start=+\${+ end=+}+ contains=TOP
" Braces nest, so that the end of an interpolation is found.
syntax region rhaiBraces transparent start="{" end="}" contains=TOP

syntax match rhaiLineComment "//.*$" contains=@Spell
syntax match rhaiDocComment "//[/!].*$" contains=@Spell
syntax region rhaiBlockComment start="/\*" end="\*/" contains=rhaiBlockComment,@Spell

runtime! syntax/rhai-droptower.vim

highlight default link rhaiConditional Conditional
highlight default link rhaiRepeat Repeat
highlight default link rhaiStatement Statement
highlight default link rhaiException Exception
highlight default link rhaiInclude Include
highlight default link rhaiDeclaration Keyword
highlight default link rhaiBoolean Boolean
highlight default link rhaiThis Special
highlight default link rhaiNumber Number
highlight default link rhaiFunction Function
highlight default link rhaiDroptower Function
highlight default link rhaiEscape SpecialChar
highlight default link rhaiString String
highlight default link rhaiCharacter Character
highlight default link rhaiTemplate String
highlight default link rhaiDelimiter Delimiter
highlight default link rhaiLineComment Comment
highlight default link rhaiDocComment SpecialComment
highlight default link rhaiBlockComment Comment

let b:current_syntax = "rhai"
