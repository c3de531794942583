# Vivado's commands as far as build.tcl and the constraints use them, for tclsh. Each knows its arguments (UG835), and the objects of the
# netlist that the file NETLIST describes; messages have Vivado's severities, and set_msg_config changes them. Anything else is an unknown
# command, and an error. Every command is written down in the file COMMANDS. Reports have the form that Vivado prints: check_timing and
# report_bus_skew of the netlist, the others as in the folder REPORTS. FORM is the form that is taken of each, older or newer. FAULT is what
# goes wrong: slack (of the screen), calculator_slack, calculator_hold, critical, pad, or a report that then has a violation: utilization, clock_interaction, bus_skew, pulse_width, cdc,
# methodology, drc.
#
# NETLIST is made of: `port NAME DIRECTION`; `cell NAME MODULE`; `pin NAME`; `register NAME CLOCK`, CLOCK a port or pin; `derived PIN CLOCK`;
# `crossing REGISTER PIN`: a way from one clock to another; `input PORT`, `output PORT`: with a register behind; `pad REGISTER PORT`: one that asks
# for a place in a pad, PORT "" where it has none beside it; `image NAME WORDS`.

set log [open $env(COMMANDS) w]
set fault [expr {[info exists env(FAULT)] ? $env(FAULT) : ""}]

# What a command takes: its flags, its options with a value, its least and most other arguments.
array set takes {
    create_project {{-in_memory -force} {-part} 0 2}
    set_msg_config {{-suppress -regexp} {-id -severity -string -limit -new_severity} 0 0}
    get_msg_config {{-count -limit -rules} {-id -severity} 0 0}
    set_property {{} {-dict} 1 3}
    get_property {{-min -max} {} 2 2}
    current_project {{} {} 0 1}
    current_design {{} {} 0 1}
    create_ip {{-force} {-vlnv -module_name -dir -vendor -library -name -version} 0 0}
    get_ips {{-all -regexp} {-filter} 0 1}
    generate_target {{-force} {} 2 2}
    synth_ip {{-force} {} 1 1}
    read_verilog {{-sv} {-library} 1 1}
    read_mem {{} {} 1 1}
    read_xdc {{-unmanaged -no_add} {-cells -ref -mode} 1 1}
    synth_design {{-rtl -assert -retiming} {-top -part -flatten_hierarchy -verilog_define -mode -directive -name} 0 0}
    opt_design {{-retarget -sweep} {-directive} 0 0}
    place_design {{-no_timing_driven} {-directive} 0 0}
    phys_opt_design {{-retime} {-directive} 0 0}
    route_design {{-unroute} {-directive} 0 0}
    write_checkpoint {{-force} {} 1 1}
    write_bitstream {{-force -bin_file} {} 1 1}
    report_utilization {{-hierarchical -return_string} {-file -cells} 0 0}
    report_clock_interaction {{-return_string -no_header} {-file -delay_type} 0 0}
    report_power {{-return_string} {-file} 0 0}
    report_drc {{-return_string} {-file -name -checks} 0 0}
    report_timing_summary {{-warn_on_violation -return_string -no_header} {-file -delay_type} 0 0}
    report_bus_skew {{-warn_on_violation -return_string -no_header -no_detailed_paths} {-file -cells} 0 0}
    report_pulse_width {{-warn_on_violation -return_string -no_header -all_violators} {-file -name} 0 1}
    report_cdc {{-details -summary -return_string -no_header} {-file -severity -from -to -cells} 0 0}
    report_methodology {{-return_string} {-file -name -checks -cells} 0 0}
    check_timing {{-return_string -no_header -verbose} {-file -cells} 0 0}
    get_timing_paths {{-setup -hold} {-max_paths -delay_type -from -to -nworst} 0 0}
    get_drc_checks {{} {} 0 1}
    get_iobanks {{} {-of_objects -filter} 0 1}
    get_cells {{-hierarchical} {-filter -of_objects} 0 1}
    get_pins {{-hierarchical} {-filter -of_objects} 0 1}
    get_ports {{} {-filter -of_objects} 0 1}
    get_clocks {{-include_generated_clocks} {-filter -of_objects} 0 1}
    create_clock {{-add} {-name -period -waveform} 0 1}
    create_generated_clock {{-add -invert -combinational} {-name -source -divide_by -multiply_by -master_clock -edges} 1 1}
    set_input_delay {{-min -max -clock_fall -add_delay} {-clock} 2 2}
    set_output_delay {{-min -max -clock_fall -add_delay} {-clock} 2 2}
    set_false_path {{-setup -hold} {-from -to -through} 0 0}
    set_max_delay {{-datapath_only} {-from -to -through} 1 1}
    set_bus_skew {{} {-from -to -through} 1 1}
    set_multicycle_path {{-setup -hold -start -end} {-from -to -through} 1 1}
    set_clock_groups {{-asynchronous -physically_exclusive -logically_exclusive} {-name -group} 0 0}
}
# What may stand in a file of constraints.
set constraints {
    set_property current_design get_cells get_pins get_ports get_clocks get_iobanks create_clock create_generated_clock set_input_delay
    set_output_delay set_false_path set_max_delay set_bus_skew set_multicycle_path set_clock_groups
}

# Each command takes its arguments apart and hands them on: `option` holds options and flags, `words` the rest.
foreach command [array names takes] {
    proc $command {args} "set at \[split_arguments $command \$args\]; return \[do_$command {*}\$at\]"
}

proc split_arguments {command given} {
    global takes log
    lassign $takes($command) flags options least most
    lappend flags -quiet -verbose
    set option [dict create]
    set words {}
    for {set i 0} {$i < [llength $given]} {incr i} {
        set word [lindex $given $i]
        if {$word in $flags} {
            dict set option $word 1
        } elseif {$word in $options} {
            if {[incr i] >= [llength $given]} { error "$command: $word wants a value" }
            dict lappend option $word [lindex $given $i]
        } elseif {[regexp {^-[a-z]} $word]} {
            error "$command: unknown option '$word'"
        } else {
            lappend words $word
        }
    }
    if {[llength $words] < $least || [llength $words] > $most} {
        error "$command: [llength $words] arguments, expected $least to $most"
    }
    puts $log "$command $given"
    flush $log
    return [list $option $words]
}

proc first {option name {otherwise ""}} {
    return [expr {[dict exists $option $name] ? [lindex [dict get $option $name] 0] : $otherwise}]
}

# Messages.

# A message names the file and line that caused it, if any: `place`.
set place ""
proc message {id severity text} {
    global message_rules counted place
    if {$place ne ""} { append text " \[$place\]" }
    set applied {}
    foreach rule $message_rules {
        lassign $rule of_id of_severity strings new
        if {$of_id ni [list "" $id] || $of_severity ni [list "" $severity]} { continue }
        if {[llength [lsearch -all -inline -not -exact [lmap string $strings { string first $string $text }] -1]] == [llength $strings]} { lappend applied $new }
    }
    # Which of two rules wins is nowhere documented.
    if {[llength $applied] > 1} { error "two rules of set_msg_config for \[$id\] $text" }
    if {[llength $applied] == 1} { set severity [lindex $applied 0] }
    incr counted($severity)
    incr counted($id)
    puts "$severity: \[$id\] $text"
    if {$severity eq "ERROR"} { error "\[$id\] $text" }
}
proc do_set_msg_config {option words} {
    global message_rules
    set new [first $option -new_severity]
    if {$new ni {ERROR "CRITICAL WARNING" WARNING INFO STATUS}} { error "set_msg_config: -new_severity '$new'" }
    lappend message_rules [list [first $option -id] [first $option -severity] [first $option -string] $new]
}
proc do_get_msg_config {option words} {
    global counted
    if {![dict exists $option -count]} { error "get_msg_config: only -count is known" }
    set of [first $option -id [first $option -severity]]
    return [expr {[info exists counted($of)] ? $counted($of) : 0}]
}

# The netlist.

proc port {name direction} { global port_of; set port_of($name) $direction }
proc cell {name module} { add cell $name; global module_of; set module_of($name) $module }
proc pin {name} { add pin $name }
proc register {name clock} {
    global clock_of inside
    # There are thousands: their names are taken apart once.
    set slash [string last / $name]
    set folder [string range $name 0 $slash-1]
    set last [string range $name $slash+1 end]
    lappend inside(cell,$folder) $last
    lappend inside(pin,$folder) $last/D $last/C $last/PRE $last/CLR
    set clock_of($name) $clock
}
proc derived {pin clock} { global derived_from; set derived_from($pin) $clock }
proc crossing {register pin} { global crossings; lappend crossings [list $register $pin] }
proc input {port} { global read_ports; lappend read_ports $port }
proc output {port} { global driven_ports; lappend driven_ports $port }
proc pad {register port} { global pad_of; set pad_of($register) $port }
proc image {name words} { global words_of; set words_of($name) $words }
proc add {kind name} {
    global inside
    lappend inside($kind,[file_of $name [levels $kind]]) [last_of $name [levels $kind]]
}
# A pin's name is that of its cell and its own.
proc levels {kind} { return [expr {$kind eq "pin" ? 2 : 1}] }
proc file_of {name {levels 1}} { return [join [lrange [split $name /] 0 end-$levels] /] }
proc last_of {name {levels 1}} { return [join [lrange [split $name /] end-[expr {$levels - 1}] end] /] }

# Objects are their kind and name, as in port:sysclk_p. A pattern's star does not reach across a slash, and brackets are but brackets.
proc found {kind patterns quiet id what} {
    global inside port_of clocks
    set all {}
    foreach pattern $patterns {
        set levels [levels $kind]
        set glob [string map {\[ \\\[ \] \\\]} [last_of $pattern $levels]]
        switch $kind {
            port { set names [array names port_of] }
            clock { set names [array names clocks] }
            default {
                set folder [file_of $pattern $levels]
                set names [expr {[info exists inside($kind,$folder)] ? $inside($kind,$folder) : {}}]
            }
        }
        if {$kind eq "port"} { set glob [string map {\[ \\\[ \] \\\]} $pattern] }
        set matching [lsearch -all -inline -glob $names $glob]
        if {$kind in {cell pin} && $folder ne ""} {
            set matching [lmap name $matching { set name $folder/$name }]
        }
        if {[llength $matching] == 0 && !$quiet} { message $id WARNING "No $what matched '$pattern'." }
        foreach name $matching { lappend all $kind:$name }
    }
    return $all
}
proc kept {objects filter} {
    global pad_of module_of
    set all {}
    foreach object $objects {
        set name [name_of $object]
        if {[string match "*IOB == TRUE*" $filter]} {
            if {[info exists pad_of($name)]} { lappend all $object }
        } elseif {[regexp {REF_NAME =~ (\S+)} $filter all_of pattern]} {
            if {[info exists module_of($name)] && [string match $pattern $module_of($name)]} { lappend all $object }
        } else {
            error "a filter that is not known here: $filter"
        }
    }
    return $all
}
proc name_of {object} { return [string range $object [string first : $object]+1 end] }
proc do_get_cells {option words} {
    global module_of pad_of
    if {[dict exists $option -hierarchical]} {
        set all [lmap name [concat [array names module_of] [array names pad_of]] { set name cell:$name }]
    } else {
        set all [found cell [lindex $words 0] [dict exists $option -quiet] {Vivado 12-180} cells]
    }
    return [expr {[dict exists $option -filter] ? [kept $all [first $option -filter]] : $all}]
}
proc do_get_pins {option words} { return [found pin [lindex $words 0] [dict exists $option -quiet] {Vivado 12-508} pins] }
proc do_get_ports {option words} { return [found port [lindex $words 0] [dict exists $option -quiet] {Vivado 12-584} ports] }
proc do_get_clocks {option words} {
    global clocks derived_from
    # A clock that an MMCM makes has the name of its pin here.
    if {![dict exists $option -of_objects] && [llength $words] == 0} {
        return [lmap name [lsort [concat [array names clocks] [array names derived_from]]] { set name clock:$name }]
    }
    if {![dict exists $option -of_objects]} { return [found clock [lindex $words 0] [dict exists $option -quiet] {Vivado 12-627} clocks] }
    set all {}
    foreach object [first $option -of_objects] {
        foreach {clock at} [array get clocks] { if {$at eq [name_of $object]} { lappend all clock:$clock } }
        if {[info exists derived_from([name_of $object])]} { lappend all clock:[name_of $object] }
    }
    if {[llength $all] == 0} { message {Vivado 12-1008} WARNING "No clocks found for command 'get_clocks'." }
    return $all
}
proc do_get_ips {option words} { return ip:[lindex $words 0] }
proc do_get_iobanks {option words} { return bank:[lindex $words 0] }
proc do_get_drc_checks {option words} { return check:[lindex $words 0] }
proc do_current_project {option words} { return project:it }
proc do_current_design {option words} { return design:it }

# Properties.

proc do_set_property {option words} {
    global property
    if {[dict exists $option -dict]} {
        set pairs [first $option -dict]
        set objects [lindex $words 0]
    } else {
        lassign $words name value objects
        set pairs [list $name $value]
    }
    if {[llength $objects] == 0} { message {Common 17-55} "CRITICAL WARNING" "'set_property' expects at least one object." }
    foreach object $objects {
        foreach {name value} $pairs {
            set property($object,$name) $value
            if {$name eq "CONFIG.XML_INPUT_FILE"} { read_controller $value }
            if {$object eq "design:it" && $name ni {CFGBVS CONFIG_VOLTAGE BITSTREAM.GENERAL.COMPRESS}} {
                message {Common 17-162} "CRITICAL WARNING" "Invalid option value '$name' specified for 'current_design'."
            }
        }
    }
}
proc do_get_property {option words} {
    global property fault
    lassign $words name object
    switch $name {
        NAME { return [name_of $object] }
        SLACK { return [slack $object] }
        REQUIREMENT { return 10.0 }
        LOC { return [expr {[in_pad [name_of $object]] ? "ILOGIC_X0Y1" : "SLICE_X0Y0"}] }
    }
    return [expr {[info exists property($object,$name)] ? $property($object,$name) : ""}]
}
proc has {object name} { global property; return [info exists property($object,$name)] }

# Steps of the flow.

proc must_be {step} { global done; if {$step ni $done} { error "no design is there: $step comes first" } }
proc there {files} {
    foreach file $files { if {![file isfile $file]} { message {Common 17-69} ERROR "File '$file' does not exist" } }
    if {[llength $files] == 0} { message {Common 17-163} ERROR "Missing value for option 'files'" }
}
proc do_create_project {option words} { global done; set done project }
proc do_create_ip {option words} {
    global env ip_folder
    set ip_folder [file join [first $option -dir] [first $option -module_name]]
    if {[file exists $ip_folder] && ![dict exists $option -force]} {
        message {IP_Flow 19-3478} ERROR "The IP folder '$ip_folder' is already there."
    }
    file mkdir $ip_folder
}
# Pins of the DRAM, which the controller places by itself.
proc read_controller {file} {
    global placed_by_controller
    there [list $file]
    set channel [open $file]
    foreach {all name} [regexp -all -inline {name="(ddr3_[^"]+)"} [read $channel]] { lappend placed_by_controller $name }
    close $channel
}
proc do_generate_target {option words} { global property; if {![has [lindex $words 1] CONFIG.XML_INPUT_FILE]} { error "the controller has no project file" } }
proc do_synth_ip {option words} {}
# The controller's own constraints do not all find their objects, in any design.
proc constrain_controller {} {
    global ip_folder place
    set place [file join $ip_folder [file tail $ip_folder] user_design constraints [file tail $ip_folder].xdc]:341
    message {Vivado 12-180} WARNING "No cells matched 'device_temp_sync_r1*'."
    message {Common 17-55} "CRITICAL WARNING" "'set_property' expects at least one object."
    set place ""
}
proc do_read_verilog {option words} { there [lindex $words 0]; global sources; lappend sources {*}[lindex $words 0] }
proc do_read_mem {option words} {
    there [lindex $words 0]
    global memories
    foreach file [lindex $words 0] { set memories([file tail $file]) $file }
}
proc do_read_xdc {option words} {
    there [lindex $words 0]
    global waiting done
    if {"synth" in $done} { constrain [lindex $words 0] } else { lappend waiting [lindex $words 0] }
}
# The lines of a file of constraints, one after the other.
proc constrain {file} {
    global constraints place
    set channel [open $file]
    set command ""
    set number 0
    foreach line [split [read $channel] "\n"] {
        set place $file:[incr number]
        append command $line "\n"
        if {[string match "*\\" $line] || ![info complete $command]} { continue }
        set word [lindex [split [string trim $command]] 0]
        if {$word in $constraints} {
            uplevel #0 $command
        } elseif {$word ne "" && ![string match "#*" $word]} {
            message {Designutils 20-1307} "CRITICAL WARNING" "Command '$word' is not supported in the xdc constraint file."
        }
        set command ""
    }
    close $channel
    set place ""
}
proc do_synth_design {option words} {
    global env done waiting words_of memories sources fault
    uplevel #0 source $env(NETLIST)
    lappend done synth
    if {"[first $option -top].v" ni [lmap file $sources { file tail $file }]} { error "no module [first $option -top]" }
    if {[dict get $option -verilog_define] ne {EDOF_IMAGES_BY_NAME SYNTHESIS}} { error "images are not looked for by name" }
    foreach {name words} [array get words_of] { read_image $name $words }
    constrain_controller
    foreach file $waiting { constrain $file }
    if {$fault eq "critical"} { message {Synth 8-9999} "CRITICAL WARNING" "something that nobody tolerated" }
}
# A word a line and nothing else, as many lines as words (UG901).
proc read_image {name words} {
    global memories sources place
    if {![info exists memories($name)]} {
        set place [lindex $sources 0]:1
        message {Synth 8-4445} "CRITICAL WARNING" "could not open \$readmem data file '$name'; please make sure the file is added to project"
        set place ""
        return
    }
    set channel [open $memories($name)]
    set lines [split [string trimright [read $channel] "\n"] "\n"]
    close $channel
    if {[llength $lines] != $words} { error "$name: [llength $lines] lines, expected $words" }
    set other [lsearch -not -regexp $lines {^[0-9a-fA-F]+$}]
    if {$other >= 0} { error "$name: '[lindex $lines $other]' is no word" }
}
foreach step {opt place phys_opt route} { proc do_${step}_design {option words} "must_be synth; directive $step \[first \$option -directive Default\]; do_step $step" }
# Directives of the steps that UG904 lists.
set directives {
    opt {Default Explore ExploreArea AddRemap ExploreSequentialArea RuntimeOptimized NoBramPowerOpt ExploreWithRemap}
    place {
        Default Explore WLDrivenBlockPlacement EarlyBlockPlacement ExtraNetDelay_high ExtraNetDelay_low AltSpreadLogic_high
        AltSpreadLogic_medium AltSpreadLogic_low ExtraPostPlacementOpt ExtraTimingOpt RuntimeOptimized Quick
    }
    phys_opt {
        Default Explore ExploreWithHoldFix ExploreWithAggressiveHoldFix AggressiveExplore AlternateReplication AggressiveFanoutOpt
        AlternateFlowWithRetiming AddRetime RuntimeOptimized
    }
    route {Default Explore AggressiveExplore NoTimingRelaxation MoreGlobalIterations HigherDelayCost RuntimeOptimized AlternateCLBRouting Quick}
}
proc directive {step name} {
    global directives
    if {$name ni [dict get $directives $step]} { error "${step}_design: unknown directive '$name'" }
}
proc do_step {step} {
    global done pad_of
    lappend done $step
    if {$step ne "place"} { return }
    foreach register [array names pad_of] {
        if {![in_pad $register]} { message {Place 30-722} "CRITICAL WARNING" "'$register' has IOB constraint set to TRUE, but could not be brought into the I/O." }
    }
}
proc in_pad {register} { global pad_of fault; return [expr {$pad_of($register) ne "" && $fault ne "pad"}] }
proc do_write_checkpoint {option words} { must_be synth; close [open [lindex $words 0] w] }
proc do_write_bitstream {option words} {
    global port_of placed_by_controller property
    must_be route
    foreach port [array names port_of] {
        if {$port in $placed_by_controller} { continue }
        if {![has port:$port IOSTANDARD]} { message {DRC NSTD-1} ERROR "Unspecified I/O Standard: $port." }
        if {![has port:$port PACKAGE_PIN]} { message {DRC UCIO-1} ERROR "Unconstrained Logical Port: $port." }
    }
    if {!([has design:it CFGBVS] && [has design:it CONFIG_VOLTAGE])} {
        set severity [expr {[has check:CFGBVS-1 SEVERITY] ? [string toupper $property(check:CFGBVS-1,SEVERITY)] : "WARNING"}]
        message {DRC CFGBVS-1} $severity "Missing CFGBVS and CONFIG_VOLTAGE Design Properties."
    }
    close [open [lindex $words 0] w]
}

# Constraints of time.

proc named {command option name} {
    set objects [first $option $name]
    if {[llength $objects] == 0} { message {Vivado 12-4739} "CRITICAL WARNING" "$command:No valid object(s) found for '$name'." }
    return $objects
}
proc do_create_clock {option words} {
    global clocks
    set period [first $option -period]
    if {![string is double -strict $period]} { error "create_clock: -period '$period'" }
    if {[llength [lindex $words 0]] == 0} { message {Vivado 12-4739} "CRITICAL WARNING" "create_clock:No valid object(s) found." }
    foreach object [lindex $words 0] { set clocks([first $option -name]) [name_of $object] }
}
proc do_create_generated_clock {option words} {
    global clocks
    named create_generated_clock $option -source
    foreach object [lindex $words 0] { set clocks([first $option -name]) [name_of $object] }
}
foreach direction {input output} {
    proc do_set_${direction}_delay {option words} "delay $direction \$option \$words"
}
proc delay {direction option words} {
    global clocks delayed
    set clock [first $option -clock]
    if {![info exists clocks($clock)]} { message {Vivado 12-4739} "CRITICAL WARNING" "set_${direction}_delay:No valid object(s) found for '-clock $clock'." }
    lassign $words value objects
    if {![string is double -strict $value]} { error "set_${direction}_delay: '$value' is no delay" }
    if {[llength $objects] == 0} { message {Vivado 12-4739} "CRITICAL WARNING" "set_${direction}_delay:No valid object(s) found." }
    set both [expr {![dict exists $option -min] && ![dict exists $option -max]}]
    foreach object $objects {
        foreach end {-min -max} { if {$both || [dict exists $option $end]} { set delayed([name_of $object],$end) $value } }
    }
}
# Ways that an exception takes out of the clocks' timing: from these objects, to those; {} is any.
proc except {command option} {
    global excepted
    set ends {}
    foreach name {-from -to} { lappend ends [expr {[dict exists $option $name] ? [lmap object [named $command $option $name] { name_of $object }] : "any"}] }
    if {$ends eq {any any}} { error "$command: neither -from nor -to" }
    lappend excepted $ends
}
proc do_set_false_path {option words} { except set_false_path $option }
proc do_set_max_delay {option words} {
    if {![string is double -strict [lindex $words 0]]} { error "set_max_delay: '[lindex $words 0]'" }
    if {![dict exists $option -datapath_only]} { error "set_max_delay: without -datapath_only the clocks' skew counts" }
    except set_max_delay $option
}
proc do_set_bus_skew {option words} {
    global skews
    if {![string is double -strict [lindex $words 0]]} { error "set_bus_skew: '[lindex $words 0]'" }
    lappend skews [list [named set_bus_skew $option -from] [named set_bus_skew $option -to]]
}
proc do_set_multicycle_path {option words} { error "set_multicycle_path: nothing here takes more than one cycle" }
proc do_set_clock_groups {option words} { foreach group [dict get $option -group] { if {[llength $group] == 0} { message {Vivado 12-4739} "CRITICAL WARNING" "set_clock_groups:No valid object(s) found." } } }

proc covers {ends name pin} {
    lassign $ends from to
    set register [file_of $pin]
    return [expr {($from eq "any" || $name in $from) && ($to eq "any" || $pin in $to || $register in $to)}]
}
# Ways from one clock to another that no exception has: they are timed, and fail.
proc timed_crossings {} {
    global crossings excepted timed_with
    # Several reports ask, and nothing changes between them.
    if {[info exists timed_with($excepted)]} { return $timed_with($excepted) }
    set timed {}
    foreach crossing $crossings {
        lassign $crossing register pin
        set is_excepted 0
        foreach ends $excepted { if {[covers $ends $register $pin]} { set is_excepted 1; break } }
        if {!$is_excepted} { lappend timed "$register -> $pin" }
    }
    return [set timed_with($excepted) $timed]
}
# A path is its kind and the clock that it is in, or `crossing`.
proc slack {path} {
    global fault
    switch $fault,[name_of $path] {
        slack,setup/screen_mmcm/CLKOUT0 { return -0.01 }
        calculator_slack,setup/calculator_mmcm/CLKOUT0 { return -0.4 }
        calculator_hold,hold/calculator_mmcm/CLKOUT0 { return -0.02 }
    }
    return [expr {[string match */crossing [name_of $path]] ? -1.0 : 0.05}]
}
proc do_get_timing_paths {option words} {
    must_be synth
    set kind [expr {[dict exists $option -hold] ? "hold" : "setup"}]
    lassign [lmap end {-from -to} { name_of [first $option $end] }] from to
    if {$from eq $to} { return path:$kind/$from }
    set timed [timed_crossings]
    foreach way $timed { puts "VIOLATED: $way" }
    return [expr {[llength $timed] > 0 ? "path:$kind/crossing" : {}}]
}

# A clock reaches a register if its port or pin has one, or that from which it is made.
proc has_clock {at} {
    global clocks derived_from
    foreach {clock where} [array get clocks] { if {$where eq $at} { return 1 } }
    return [expr {[info exists derived_from($at)] && [has_clock $derived_from($at)]}]
}
# What a file of the folder REPORTS has, of the form FORM.
proc recorded {report fault} {
    global env
    set files [lsort [glob -directory [file join $env(REPORTS) $report] *.rpt]]
    set files [lsearch -all -inline {*}[expr {$fault ? "" : "-not"}] $files *.violation.rpt]
    set channel [open [lindex $files [expr {$env(FORM) eq "newer" ? "end" : 0}]]]
    set text [read $channel]
    close $channel
    return $text
}
proc is_newer {} { global env; return [expr {$env(FORM) eq "newer"}] }
# The part above the line `until` of a recorded report, and that line: its header and title.
proc head_of {report until} {
    set text [recorded $report 0]
    return [string range $text 0 [string first $until $text]+[string length $until]]
}

# A sentence of check_timing: how many there are, with the names below; a pair in `what` is for one and for many.
proc sentence {names what {stop "."} {severity HIGH}} {
    set count [llength $names]
    set text " There [expr {$count == 1 ? "is" : "are"}] $count [expr {$count == 1 ? [lindex $what 0] : [lindex $what end]}]$stop"
    if {$count > 0} { append text " ($severity)\n\n[join $names "\n"]" }
    return [list $count "$text\n\n"]
}
# Sections, each with its sentences; newer forms count the objects in the titles.
proc timing_sections {sections} {
    set contents ""
    set details ""
    foreach {check sentences} $sections {
        set title "[incr number]. checking $check"
        if {[is_newer]} { append title " ([tcl::mathop::+ {*}[lmap sentence $sentences { lindex $sentence 0 }]])" }
        append contents "$title\n"
        append details "\n$title\n[string repeat - [string length $title]]\n[join [lmap sentence $sentences { lindex $sentence 1 }] ""]"
    }
    return "\nTable of Contents\n-----------------\n$contents$details"
}
proc do_check_timing {option words} {
    global clock_of read_ports driven_ports delayed excepted clocks
    must_be route
    set unclocked {}
    foreach {register clock} [array get clock_of] { if {![has_clock $clock]} { lappend unclocked $register/C } }
    foreach {kind ports end} [list input $read_ports 0 output $driven_ports 1] {
        foreach list {none free partial forwarded} { set $list {} }
        foreach port [lsort $ports] {
            set ends [expr {[info exists delayed($port,-min)] + [info exists delayed($port,-max)]}]
            set is_free [expr {[lsearch -exact [concat {*}[lmap exception $excepted { lindex $exception $end }]] $port] >= 0}]
            if {$port in [dict values [array get clocks]]} {
                if {$kind eq "output"} { lappend forwarded $port }
            } elseif {$ends == 1} {
                lappend partial $port
            } elseif {$ends == 0} {
                if {$is_free} { lappend free $port } else { lappend none $port }
            }
        }
        set word [expr {$kind eq "input" ? "input port" : "port"}]
        set stop [expr {$kind eq "input" ? "." : ""}]
        set no($kind) [list \
            [sentence $none [list "$word with no $kind delay specified" "${word}s with no $kind delay specified"]] \
            [sentence $free [lmap ports [list $word ${word}s] { string cat "$ports with no $kind delay but user has a false path constraint" }] $stop MEDIUM]]
        set partial_of($kind) [list [sentence $partial [list "$word with partial $kind delay specified" "${word}s with partial $kind delay specified"]]]
    }
    lappend no(output) [sentence $forwarded [lmap ports {port ports} { string cat $ports " with no output delay but with a timing clock defined on it or propagating through it" }] "" LOW]
    set sections [list \
        no_clock [list [sentence [lsort $unclocked] [list "register/latch pins with no clock"]]] \
        constant_clock [list [sentence {} [list "register/latch pins with constant_clock"]]] \
        pulse_width_clock [list [sentence {} [list "register/latch pins which need pulse_width check"] ""]] \
        unconstrained_internal_endpoints [list \
            [sentence {} [list "pins that are not constrained for maximum delay"]] \
            [sentence {} [list "pins that are not constrained for maximum delay due to constant clock"]]] \
        no_input_delay $no(input) no_output_delay $no(output) \
        multiple_clock [list [sentence {} [list "register/latch pins with multiple clocks"]]] \
        generated_clocks [list [sentence {} [list "generated clocks that are not connected to a clock source"]]] \
        loops [list [sentence {} [list "combinational loops in the design"]]] \
        partial_input_delay $partial_of(input) partial_output_delay $partial_of(output) \
        latch_loops [list [sentence {} [list "combinational latch loops in the design through latch input"] ""]]]
    return [reported $option [head_of check_timing "check_timing report"][timing_sections $sections]]
}

# Reports.

foreach kind {utilization clock_interaction power drc timing_summary pulse_width cdc methodology} {
    proc do_report_$kind {option words} "must_be synth; return \[reported \$option \[says_$kind\]\]"
    proc says_$kind {} "global fault; return \[recorded $kind \[expr {\$fault eq {$kind}}\]\]"
}
proc reported {option text} {
    if {[dict exists $option -file]} {
        set channel [open [first $option -file] w]
        puts $channel $text
        close $channel
    }
    return [expr {[dict exists $option -return_string] ? $text : ""}]
}
proc says_power {} { return "" }
proc says_timing_summary {} { return "" }
proc do_report_bus_skew {option words} {
    global skews fault
    if {[llength $skews] == 0} { return [reported $option "[head_of bus_skew "Bus Skew Report"]\nNo bus skew constraints\n"] }
    set text [head_of bus_skew "  Slack(ns)"]
    append text "--  --------  ------------------------------  ------------------------------  ------  ---------------  ----------  ---------\n"
    set glue [expr {[is_newer] ? " \\\n          " : " "}]
    foreach skew $skews {
        lassign [lmap end $skew { string cat "\[get_cells \[list " [join [lmap cell $end { string cat "{" [name_of $cell] "}" }] $glue] "\]\]" }] from to
        set slack [expr {$fault eq "bus_skew" ? -0.433 : 5.763}]
        append text [format "%-3d %-9d %s\n%46s%s\n%78sSlow    %15.3f  %10.3f  %9.3f\n" [incr number] [expr {2 * $number}] $from "" $to "" 6.667 [expr {6.667 - $slack}] $slack]
    }
    return [reported $option "$text\n\n2. Bus Skew Report Per Constraint\n---------------------------------\n"]
}

foreach list {message_rules crossings excepted skews waiting sources read_ports driven_ports placed_by_controller done} { set $list {} }
foreach table {port_of clocks module_of pad_of property inside clock_of delayed} { array set $table {} }
