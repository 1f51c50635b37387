" Vim filetype plugin: comments of Rhai, and `:make`.
if exists("b:did_ftplugin")
  finish
endif
let b:did_ftplugin = 1

setlocal comments=s0:/*,mb:\ *,ex:*/,:///,://!,://
setlocal commentstring=//\ %s
compiler droptower

let b:undo_ftplugin = "setlocal comments< commentstring< makeprg< errorformat<"
